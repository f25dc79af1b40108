#include "tracer/bake/field/contract/contract.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "grid/base/error.h"
#include "grid/field/resolve.h"
#include "tracer/bake/field/contract/journal.h"
#include "tracer/bake/field/contract/planner.h"
#include "tracer/bake/field/contract/state.h"

namespace ivory {
namespace {

constexpr std::uint64_t points_a_round = std::uint64_t(1) << 36U;  // of the domain, that a certificate may take
constexpr int most_rounds = 4;

void bake_chosen(ContractState& state, const Journal& journal) {
  SumsAtHand& at_hand = state.at_hand;
  const Lattice& lattice = state.chosen_candidate().lattice;
  GridBakeParams bake = state.chosen_candidate().bake;
  bake.lattice = lattice;
  bake.photons = state.chosen.photons;
  bake.checkpoint = journal.policy();
  const Stopwatch watch;
  // Where photons are sent was found out for so many of them; for many more it is worth another look.
  constexpr double stale = 8;
  const bool goes_on =
      at_hand.stand_on(lattice) && at_hand.photons <= state.chosen.photons &&
      (bake.emission != EmissionMode::guided || double(state.chosen.photons) <= stale * double(at_hand.guide_photons));
  state.note(fmt::format("{} {} vertices on {} level{}, {:.4g} m apart{}, to {} photons",
                         journal.is_known() ? "done before:"
                         : goes_on          ? "going on with"
                                            : "baking",
                         lattice.vertex_count(), lattice.levels(), lattice.levels() == 1 ? "" : "s",
                         spacing_of(lattice.finest_frame()), lattice.levels() == 1 ? "" : " on the finest",
                         state.chosen.photons));
  if (!goes_on) {
    at_hand.sums.reset();
    at_hand.guide_photons = state.chosen.photons;
  }
  if (journal.is_known()) {
    // A checkpoint has the sums, of these photons and of some that came after.
    at_hand.sums.emplace();
    static_cast<Lattice&>(*at_hand.sums) = lattice;
  } else if (!goes_on) {
    at_hand.sums = bake_grid_sums(state.lit, bake);
  } else if (at_hand.photons < state.chosen.photons) {
    bake.pilot_for_photons = at_hand.guide_photons;
    bake.photon_range = {{at_hand.photons, state.chosen.photons}};
    at_hand.sums = bake_grid_sums(state.lit, bake, std::exchange(at_hand.sums, std::nullopt));
  }
  state.times.measured += watch.seconds();
  state.times.modelled += state.chosen.seconds;
  at_hand.photons = state.chosen.photons;
}

// `round` counts from 1; `bake_seconds`: what bakes took on the cost model's machine, the pilots not counted.
std::optional<FieldCertificate> certificate(const ContractState& state, int round, double bake_seconds) {
  CertificateParams measure;
  measure.target = state.params.target;
  measure.lookup = state.params.lookup;
  measure.truth = state.truth;
  measure.first_point = std::uint64_t(round - 1) * points_a_round;
  // Half of the bake's own work at most, or some seconds.
  constexpr double least_paths = 1'000'000;
  constexpr double path_s = 2e-6;  // of the cost model's machine
  measure.most_paths = std::uint64_t(std::clamp(bake_seconds / 2 / path_s, least_paths, double(measure.most_paths)));
  return certify(state.lit, resolve(*state.at_hand.sums), state.domain, measure);
}

// What was measured takes the place of what was predicted. False where it is no more than the target, and where
// nothing within bounds promises less.
bool improve(ContractState& state, const ReachedError& reached) {
  const double error = reached.error;
  if (error <= state.params.target) return false;
  const double noise = std::min(reached.noise, 0.95 * error);
  const PilotErrors here{spacing_of(state.at_hand.sums->finest_frame()), double(state.at_hand.photons),
                         std::sqrt(std::max(error * error - noise * noise, 1e-8)), noise};
  std::erase_if(state.pilots, [&](const PilotErrors& p) { return p.spacing_m <= here.spacing_m * 1.05; });
  state.pilots.push_back(here);
  const Plan before = state.chosen;
  choose(state);
  if (state.chosen.spacing == before.spacing && state.chosen.photons <= before.photons) return false;
  constexpr double worth = 0.95;
  if (!state.chosen.meets && !(state.chosen.error < worth * error)) return false;
  if (!can_afford(state)) {
    state.note(fmt::format("error {:.2g} % is above {:.2g} %, but going on would take {:.2g} times the work so far",
                           100 * error, 100 * state.params.target, *state.too_dear));
    return false;
  }
  state.note(fmt::format("error {:.2g} % is above {:.2g} %: going on", 100 * error, 100 * state.params.target));
  return true;
}

int thread_limit(const ContractParams& params) {
  return params.bake.threads > 0 ? params.bake.threads : tbb::this_task_arena::max_concurrency();
}

}  // namespace

GridPlan plan_grid(const LitScene& lit, const ContractParams& params) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(thread_limit(params)));
  ContractState state(lit, params);
  return make_plan(state);
}

ContractResult bake_to_error(const LitScene& lit, const ContractParams& params) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(thread_limit(params)));
  Journal journal(lit, params);
  ContractState state(lit, params);
  ContractResult out;
  out.plan = make_plan(state);
  out.by_clock = params.most_seconds.has_value();
  if (state.points.mean_e_lux <= 0) {
    GridBakeParams bake = params.bake;
    bake.photons = out.plan.photons;
    bake.checkpoint = journal.policy();
    out.sums = bake_grid_sums(lit, bake);
    return out;
  }
  double bake_seconds = 0;
  for (out.rounds = 1;; ++out.rounds) {
    bake_chosen(state, journal);
    bake_seconds += state.chosen.seconds;
    // The points of the plan see at no cost what is plainly not enough: certificates are for what may be.
    if (out.rounds < most_rounds && improve(state, journal.reached([&] {
          return error_at(state.points, resolve(*state.at_hand.sums), lit.intersector, params.lookup);
        })))
      continue;
    const ReachedError reached = journal.reached([&]() -> ReachedError {
      state.note(fmt::format("measuring the error against path tracing"));
      out.certificate = certificate(state, out.rounds, bake_seconds);
      if (!out.certificate) return {};
      const std::map<std::string, double>& parts = out.certificate->summary.parts;
      const auto noise = parts.find("noise");
      return {out.certificate->interval.error, noise == parts.end() ? 0.0 : noise->second};
    });
    if (out.rounds == most_rounds || !improve(state, reached)) break;
  }
  if (out.certificate && out.certificate->interval.error > params.target && out.plan.limited_by.empty()) {
    const std::string cause = what_limits(state);
    out.plan.limited_by = cause.empty() ? "predictions that promised too much" : cause;
  }
  out.sums = std::move(*state.at_hand.sums);
  if (out.sums.sums.empty())  // decided otherwise than before: memory may be less
    throw Error(lit.scene->name, "this machine would not go on as its checkpoint does", "remove that, or go on there");
  return out;
}

}  // namespace ivory
