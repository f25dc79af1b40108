#include "tracer/bake/field/contract/planner.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include "tracer/bake/field/contract/direction.h"
#include "tracer/bake/field/contract/pilots.h"

namespace ivory {
namespace {

// Less than this on the cost model's machine nobody minds.
constexpr double cheap_s = 30;

// Do two halvings take less than a tenth off the bias each? Then something else than the spacing makes it, and finer
// vertices would only cost.
bool stalls(const ContractState& state) {
  constexpr double worth = 0.9;
  const std::size_t n = state.pilots.size();
  return n >= 3 && state.pilots[n - 1].bias > worth * state.pilots[n - 2].bias &&
         state.pilots[n - 2].bias > worth * state.pilots[n - 3].bias;
}

void stop_refining(ContractState& state) {
  if (state.candidates.is_single()) return;
  const double finest = 0.99 * state.pilots.back().spacing_m;
  std::erase_if(state.candidates.list, [&](const GridCandidate& c) { return spacing_of(c.finest()) < finest; });
  state.candidates.limited_by = "an error that does not fall with the spacing";
}

void measure_direction(ContractState& state) {
  if (state.params.bake.include_direct) return;
  std::vector<MeasuredPoint> points;
  for (const TruePoint& point : state.points.lit) points.push_back({point, {}, {}});
  const DirectionErrors errors =
      direction_errors(state.lit, points, pilot_lattice(state, 2 * coarsest_layers).finest_frame(),
                       state.points.mean_e_lux, state.truth);
  state.direction_sh9 = errors.sh9;
  if (state.params.bake.basis == Basis::vectors) state.direction = errors.vectors;
  if (state.params.bake.basis == Basis::vectors9) state.direction = errors.vectors9;
  if (state.params.bake.basis == Basis::sh9) state.direction = errors.sh9;
}

PlanLimits plan_limits(const ContractState& state) {
  PlanLimits limits;
  limits.aim = aim_of_target * state.params.target;
  if (state.params.bake.photons != 0) limits.photons = double(state.params.bake.photons);
  if (state.params.most_work) {
    GridBakeParams usual = state.params.bake;
    usual.resolution.reset();
    usual.voxel_size_m = float(longest_m(state.cover) / default_long_side);
    const std::size_t vertices = default_frame(*state.lit.scene, usual).vertex_count();
    limits.most_seconds = *state.params.most_work *
                          state.costs.seconds(double(vertices), default_long_side, double(default_photons(vertices)));
  }
  if (state.params.most_seconds) {
    const double left = *state.params.most_seconds - state.since_start.seconds() -
                        state.points.certificate_paths * state.points.path_seconds;
    limits.most_seconds = std::min(limits.most_seconds.value_or(std::numeric_limits<double>::infinity()),
                                   std::max(0.0, left) / state.times.scale());
  }
  return limits;
}

GridPlan describe(const ContractState& state) {
  GridPlan plan;
  const Lattice& lattice = state.chosen_candidate().lattice;
  plan.frame = lattice.finest_frame();
  plan.levels = lattice.levels();
  plan.vertices = lattice.vertex_count();
  plan.photons = state.chosen.photons;
  // RMS differences between spacings guess the error to within 0.77 to 1.5; points with their truth do better.
  plan.error = {0.8 * state.chosen.error, state.chosen.error, 1.25 * state.chosen.error};
  plan.bias = state.chosen.bias;
  plan.noise = state.chosen.noise;
  plan.direction = state.model.direction;
  plan.direction_sh9 = state.direction_sh9;
  const double bake_seconds = state.chosen.seconds * state.times.scale();
  const double seconds = bake_seconds + state.points.certificate_paths * state.points.path_seconds;
  plan.seconds = {0.6 * seconds, seconds, 1.8 * seconds};
  const int threads =
      state.params.bake.threads > 0 ? state.params.bake.threads : tbb::this_task_arena::max_concurrency();
  const double one = grid_memory_bytes(lattice, state.params.bake, 1);
  const double all = grid_memory_bytes(lattice, state.params.bake, threads);
  plan.memory_bytes = {one, std::min(all, memory_limit_bytes(state.params.bake)), all};
  // Moments and variance of all lights and of each group that is kept apart; visible fraction and guard.
  const auto groups = state.params.bake.groups ? state.params.bake.groups->names.size() : 0;
  const double a_vertex = (12.0 * function_count(state.params.bake.basis) + 12) * double(1 + groups) + 4 + 16;
  const double file = a_vertex * state.at_hand.stored_share * double(plan.vertices);
  // What rounding and compression leave: 51 bytes of 176 at 11 photons a vertex, 71 at 1,400.
  plan.file_bytes = {0.2 * file, 0.35 * file, 0.7 * file};
  plan.meets = state.chosen.meets;
  if (!plan.meets) plan.limited_by = what_limits(state);
  plan.pilots = state.pilots;
  return plan;
}

// The bake that would be made without any of this.
GridPlan unknown_plan(const ContractState& state) {
  GridPlan plan;
  const Lattice usual = default_lattice(*state.lit.scene, state.params.bake);
  plan.frame = usual.finest_frame();
  plan.vertices = usual.vertex_count();
  plan.photons = state.params.bake.photons != 0 ? state.params.bake.photons : default_photons(plan.vertices);
  plan.limited_by = "light: it reaches too little of the domain to plan by";
  return plan;
}

}  // namespace

GridPlan make_plan(ContractState& state) {
  state.points = find_planning_points(state.lit, state.domain, state.params.target, state.truth);
  state.candidates = make_candidates(*state.lit.scene, state.params.bake, state.cover);
  if (state.points.mean_e_lux <= 0) return unknown_plan(state);
  const bool fixed = state.candidates.is_single();
  double layers =
      fixed ? std::min(double(coarsest_layers), layers_of(state.candidates.list[0].finest())) : coarsest_layers;
  add_pilot(state, layers);
  if (!fixed || layers * 2 <= layers_of(state.candidates.list[0].finest())) add_pilot(state, layers *= 2);
  measure_direction(state);
  choose(state);
  // Extrapolating by more than 1.8 is not to be trusted; a pilot of twice the resolution is to cost a quarter of the
  // bake at most.
  constexpr double far = 1.8;
  constexpr double worth = 0.25;
  for (;;) {
    const GridFrame& chosen = state.chosen_candidate().finest();
    const double spacing_m = longest_m(state.cover) / (2 * layers);
    if (spacing_of(chosen) * far >= 2 * spacing_m) break;
    if (pilot_seconds(state, 2 * layers) > worth * state.chosen.seconds) break;
    add_pilot(state, layers *= 2);
    if (stalls(state)) stop_refining(state);
    choose(state);
  }
  // A plan's time is good to a factor of two; what takes three times as much was planned wrongly.
  constexpr double patience = 3;
  state.most_work = patience * (state.times.modelled + state.chosen.seconds);
  return describe(state);
}

void choose(ContractState& state) {
  std::vector<Spacing> spacings;
  for (const GridCandidate& c : state.candidates.list) {
    const bool at_hand = state.at_hand.stand_on(c.lattice);
    spacings.push_back({spacing_of(c.finest()), double(c.lattice.vertex_count()), layers_of(c.finest()),
                        at_hand ? double(state.at_hand.photons) : 0});
  }
  state.model = fit_errors(state.pilots, state.direction);
  PlanLimits limits = plan_limits(state);
  state.chosen = choose_plan(spacings, state.model, state.costs, limits);
  state.too_dear.reset();
  const bool is_planned = state.most_work > 0;  // later rounds have can_afford()
  if (is_planned || limits.most_seconds || !state.chosen.meets || state.chosen.seconds < cheap_s) return;
  // Work goes as the sixth to the eighth power of the error where nothing but spacing and photons makes it: a quarter
  // more for a quarter to a sixth of the work. Where the rest costs more than that by far, something else bounds it.
  constexpr double a_quarter_more = 1.25;
  constexpr double too_much = 10;
  limits.aim *= a_quarter_more;
  Plan less = choose_plan(spacings, state.model, state.costs, limits);
  if (!less.meets || state.chosen.seconds < too_much * less.seconds) return;
  state.too_dear = state.chosen.seconds / std::max(less.seconds, 1.0);
  less.meets = false;
  state.chosen = less;
}

bool can_afford(ContractState& state) {
  if (state.params.most_seconds || state.params.most_work) return true;  // bounds of their own
  if (state.times.modelled + state.chosen.seconds <= std::max(state.most_work, cheap_s)) return true;
  state.too_dear = state.chosen.seconds / state.times.modelled;
  return false;
}

std::string what_limits(const ContractState& state) {
  if (state.too_dear) {
    return fmt::format(
        "its price: reaching what was asked for is reckoned to take {:.2g} times the work; --max-time "
        "allows more",
        *state.too_dear);
  }
  if (state.model.direction > aim_of_target * state.params.target)
    return fmt::format("the directional basis, which alone is {:.2g} % off", 100 * state.model.direction);
  if (state.params.bake.photons != 0) return "the photons, whose number is given";
  if (state.params.most_seconds) return "the time that is given";
  if (state.params.most_work) return "the work of a bake that no error was asked for";
  return state.candidates.limited_by;
}

}  // namespace ivory
