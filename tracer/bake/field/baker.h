// From a scene to the integer sums of an irradiance-vector grid.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "grid/field/accumulator.h"
#include "tracer/core/lit_scene.h"

namespace ivory {

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
  Guard guard = Guard::rays;  // planes and rays store the compact guard; off stores and applies none
  bool include_direct = false;
  std::uint64_t seed = 1;
  int threads = 0;                     // 0: all cores
  std::uint64_t max_memory_bytes = 0;  // 0: three quarters of the machine's
  std::function<void(std::uint64_t done, std::uint64_t total)>
      progress;  // photons; called from any thread, one at a time
};

// Where the grid lies: it tiles `bounds`, or those of the scene along the grid's axes, exactly by `resolution` or,
// about their centre, by cubic voxels. Flat sides get a twentieth of the longest. A turn by rotate_y_deg takes world +Z
// towards +X. Throws Error for a scene without extent, and ParameterError for a resolution or voxel size that is below
// 2 vertices an axis, not finite, or too fine to number the vertices. With several levels it is the finest one's frame,
// its sides rounded up to multiples of 2^levels vertices, mostly at the far ends.
GridFrame default_frame(const Scene& scene, const GridBakeParams& params);

// params.frame, or default_frame(), as the finest of params.levels levels: make_scene_lattice(), finest in
// params.dynamic_regions too. Throws as they do, and Error where its tables do not fit into params.max_memory_bytes.
Lattice default_lattice(const Scene& scene, const GridBakeParams& params);

// The sphere around the grid's cells, which photons are sent to.
EmissionTarget emission_target(const GridFrame& frame, const GridBakeParams& params);

// What baking that grid takes on so many threads; less where no light is so much weaker than another that its photons
// need sums of a finer unit.
double grid_memory_bytes(const Lattice& lattice, const GridBakeParams& params, int threads);
// params.max_memory_bytes, or what stands for it.
double memory_limit_bytes(const GridBakeParams& params);

// Throws Error where that grid cannot be baked within params.max_memory_bytes even on one thread: affordable_threads()
// before there is a LitScene.
void check_grid_memory(const Scene& scene, const Lattice& lattice, const GridBakeParams& params);

// How many of params.threads (0: all) can bake that grid within params.max_memory_bytes: each needs sums of its own,
// where they are small (DepositBuffers). At least 1; throws Error where memory would not suffice for one.
int affordable_threads(const LitScene& lit, const Lattice& lattice, const GridBakeParams& params);

// Traces the photons and returns what they left, on affordable_threads(); the sums do not depend on how many. Throws
// Error where nothing shines, where memory would not suffice, and as default_lattice() does.
GridAccumulator bake_grid_sums(const LitScene& lit, const GridBakeParams& params);

}  // namespace ivory
