// What a bake of an irradiance-vector grid is told.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "grid/base/names.h"
#include "grid/field/accumulator.h"
#include "tracer/bake/checkpoint.h"
#include "tracer/lights/groups.h"

namespace ivory {

// Where photons are sent.
enum class EmissionMode {
  guided,  // where a pilot found that they come to the grid; dark places get more of them
  bounds,  // suns and skies at the grid's bounds, lamps all around
  even,    // suns and skies over the whole scene, lamps all around
};
template <>
inline constexpr auto name_table<EmissionMode> = make_name_table<EmissionMode>(
    "emission", {{EmissionMode::guided, "guided"}, {EmissionMode::bounds, "bounds"}, {EmissionMode::even, "even"}});

struct GridBakeParams {
  std::optional<GridFrame> frame = std::nullopt;     // places the grid by hand; none: default_frame()
  std::optional<Lattice> lattice = std::nullopt;     // where its vertices stand; none: default_lattice()
  std::optional<Box3f> bounds = std::nullopt;        // what the grid covers, of the scene; none: all of it
  float rotate_y_deg = 0;                            // about the vertical through the grid's middle, after `bounds`
  std::optional<V3i> resolution = std::nullopt;      // vertices per axis, each at least 2
  std::optional<float> voxel_size_m = std::nullopt;  // cubic voxels; neither given: 32 along the longest side
  int levels = 1;             // of spacing: finest near surfaces, each coarser one twice the one before; 1: uniform
  std::uint64_t photons = 0;  // of the whole bake; 0: 256 a vertex, at least a million
  std::optional<std::pair<std::uint64_t, std::uint64_t>> photon_range = std::nullopt;  // half-open; none: all
  // Boxes of the scene in which objects move. Given, even if empty, vertices far from all surfaces are stored
  // only there; none: everywhere.
  std::optional<std::vector<Box3f>> dynamic_regions = std::nullopt;
  int max_bounces = 1000;
  Basis basis = Basis::vectors;
  Estimator estimator = Estimator::track;
  Guard guard = Guard::rays;          // planes and rays store the compact guard; off stores and applies none
  DirectSources include_direct = {};  // whose light is also stored as it comes straight from them; true: of all
  // Lights whose sums are kept apart, of the LitScene's lights; none: only the sums of all are kept. The photons, and
  // with them the sums of all, are the same.
  std::optional<LightGroups> groups = std::nullopt;
  EmissionMode emission = EmissionMode::guided;  // changes no mean
  // How many photons the pilot of a guided bake and the search for lit vertices are made for; 0: `photons`. Bakes that
  // differ in nothing but `photons` and their ranges have the same where this is given, and their parts may be merged.
  std::uint64_t pilot_for_photons = 0;
  std::uint64_t seed = 1;
  int threads = 0;                     // 0: all cores
  std::uint64_t max_memory_bytes = 0;  // 0: three quarters of the machine's
  std::function<void(std::uint64_t done, std::uint64_t total)> progress =
      nullptr;  // photons; called from any thread, one at a time
  std::function<void(std::uint64_t done, std::uint64_t total)> pilot_progress =
      nullptr;  // the same of the pilot, before
  std::optional<CheckpointPolicy> checkpoint = std::nullopt;
};

}  // namespace ivory
