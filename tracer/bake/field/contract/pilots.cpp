#include "tracer/bake/field/contract/pilots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "grid/field/resolve.h"

namespace ivory {
namespace {

// A pilot's noise is to be no more than its bias, or than what is aimed at: then the bias is told from it.
constexpr double least_pilot_photons = 64'000;
constexpr double least_pilot_photons_a_vertex = 8;
constexpr double most_pilot_photons_a_vertex = 256;

double pilot_photons(const ContractState& state, const Lattice& lattice) {
  const double vertices = double(lattice.vertex_count());
  const double least = std::max(least_pilot_photons, least_pilot_photons_a_vertex * vertices);
  if (state.pilots.empty()) return least;
  const ErrorModel model = fit_errors(state.pilots, 0);
  const double spacing_m = spacing_of(lattice.finest_frame());
  const double noise = std::max(model.bias(spacing_m), aim_of_target * state.params.target);
  const double photons = model.noise_photons / std::pow(noise * spacing_m, 2);
  return std::clamp(photons, least, std::max(least, most_pilot_photons_a_vertex * vertices));
}

GridBakeParams pilot_params(const ContractState& state, double layers) {
  GridBakeParams bake = state.params.bake;
  bake.progress = nullptr;
  bake.pilot_progress = nullptr;
  bake.checkpoint.reset();
  if (state.candidates.is_single() && layers_of(state.candidates.list[0].finest()) <= layers) {
    bake.lattice = state.candidates.list[0].lattice;
    return bake;
  }
  bake.frame.reset();
  bake.resolution.reset();
  constexpr double hair = 1 + 1e-6;
  bake.voxel_size_m = float(longest_m(state.cover) * hair / layers);
  if (!state.candidates.is_single()) bake.levels = levels_for(layers, bake.estimator);
  bake.lattice = default_lattice(*state.lit.scene, bake);
  return bake;
}

// Two halves of its photons tell the grid's bias, (a - E)(b - E), and the noise of both together, (a - b)^2 / 4,
// without a model of either.
PilotErrors bake_pilot(ContractState& state, GridBakeParams bake, double photons_wanted) {
  const Lattice& lattice = *bake.lattice;
  const GridFrame& frame = lattice.finest_frame();
  const auto photons = std::uint64_t(photons_wanted) / 2 * 2;
  state.at_hand.guide_photons = photons;
  bake.pilot_for_photons = photons;
  const Stopwatch watch;
  bake.photons = photons;
  bake.photon_range = {{0, photons / 2}};
  GridAccumulator first = bake_grid_sums(state.lit, bake);
  bake.photon_range = {{photons / 2, photons}};
  GridAccumulator second = bake_grid_sums(state.lit, bake);
  state.times.measured += watch.seconds();
  state.times.modelled +=
      2 * state.costs.seconds(double(lattice.vertex_count()), layers_of(frame), double(photons) / 2);
  const IrradianceGrid a = resolve(first);
  const IrradianceGrid b = resolve(second);
  std::vector<std::array<double, 3>> squares(state.points.lit.size());
  tbb::parallel_for(std::size_t(0), state.points.lit.size(), [&](std::size_t i) {
    const TruePoint& point = state.points.lit[i];
    const V3d ea = read_grid(a, state.lit.intersector, point.at, state.params.lookup).e;
    const V3d eb = read_grid(b, state.lit.intersector, point.at, state.params.lookup).e;
    squares[i] = {(ea - point.truth.e).dot(eb - point.truth.e) / 3 - mean_of(point.truth.variance),
                  (ea - eb).length2() / 12, point.at.weight};
  });
  double bias = 0;
  double noise = 0;
  double weights = 0;
  for (const auto& [bias_square, noise_square, weight] : squares) {
    bias += weight * bias_square;
    noise += weight * noise_square;
    weights += weight;
  }
  constexpr double least_bias = 0.001;  // less is not told from nothing
  const PilotErrors errors{spacing_of(frame), double(photons),
                           std::max(least_bias, std::sqrt(std::max(0.0, bias / weights)) / state.points.mean_e_lux),
                           std::sqrt(noise / weights) / state.points.mean_e_lux};
  state.note(fmt::format("pilot of {}x{}x{} vertices, {} photons: bias {:.2g} %, noise {:.2g} %", frame.size.x,
                         frame.size.y, frame.size.z, photons, 100 * errors.bias, 100 * errors.noise));
  double stored = 0;
  for (const float fraction : first.visible_fraction) stored += fraction > 0 ? 1 : 0;
  state.at_hand.stored_share = stored / double(lattice.vertex_count());
  state.at_hand.sums = std::move(first);
  state.at_hand.add(std::move(second));
  state.at_hand.photons = photons;
  return errors;
}

}  // namespace

void add_pilot(ContractState& state, double layers) {
  const GridBakeParams bake = pilot_params(state, layers);
  const double photons = pilot_photons(state, *bake.lattice);
  PilotErrors errors = bake_pilot(state, bake, photons);
  // The first one's photons are a guess.
  constexpr double too_much = 1.5;
  constexpr double most_times = 32;
  if (const double noise = std::max(errors.bias, aim_of_target * state.params.target);
      state.pilots.empty() && errors.noise > too_much * noise) {
    errors = bake_pilot(state, bake, photons * std::min(most_times, std::pow(errors.noise / noise, 2)));
  }
  state.pilots.push_back(errors);
}

double pilot_seconds(const ContractState& state, double layers) {
  const Lattice lattice = *pilot_params(state, layers).lattice;
  if (grid_memory_bytes(lattice, state.params.bake, 1) > memory_limit_bytes(state.params.bake))
    return std::numeric_limits<double>::infinity();
  return 2 * state.costs.seconds(double(lattice.vertex_count()), layers_of(lattice.finest_frame()),
                                 pilot_photons(state, lattice) / 2);
}

Lattice pilot_lattice(const ContractState& state, double layers) { return *pilot_params(state, layers).lattice; }

}  // namespace ivory
