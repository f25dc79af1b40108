#include "tracer/bake/field/bake_memory.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "tracer/bake/field/deposit/photon_deposit.h"
#include "tracer/bake/field/deposit/target.h"
#include "tracer/bake/field/placement.h"

namespace ivory {
namespace {

struct BakeMemory {
  double shared = 0;  // by all threads
  double own = 0;     // of each
  double limit = 0;
};

// What the threads share: sums, the grid, and the tables of bricks. Each adds to its own, twice where photons of
// weak lights have sums of a finer unit, and all sums are there once more while they are sorted; unless there are so
// many that the threads share them. Besides, each keeps some segments. Groups of lights have sums each, and all
// together once more.
BakeMemory bake_memory(const Lattice& lattice, const GridBakeParams& params, int fine_bits) {
  const auto vertices = double(lattice.vertex_count());
  const SumLayout layout = sum_layout(params.basis, params.estimator);
  const std::size_t groups = params.groups ? params.groups->names.size() : 0;
  const std::size_t targets = std::max<std::size_t>(1, groups);
  const double sums = vertices * layout.stride();
  const bool own = choose_buffers(lattice.vertex_count() * targets, layout, fine_bits) == DepositBuffers::own;
  const double shared = sums * 8 * double(groups + (own ? 2 : 1)) +
                        vertices * (double(function_count(params.basis)) * 12 + 64) * double(1 + groups) +
                        table_bytes(lattice.frame, lattice.levels()) * double(targets);
  const double kept = PhotonDepositor::most_kept_bytes(lattice.vertex_count(), lattice.levels(), layout);
  return {shared, ((own ? own_bytes(lattice.vertex_count(), layout, fine_bits) : 0) + kept) * double(targets),
          memory_limit_bytes(params)};
}

void check(const std::string& scene, const Lattice& lattice, const GridBakeParams& params, const BakeMemory& memory) {
  const double needed = memory.shared + memory.own;
  if (needed <= memory.limit) return;
  constexpr double gib = 1024.0 * 1024 * 1024;
  const GridFrame& frame = lattice.finest_frame();
  const std::string coarser = params.resolution
                                  ? "for a lower resolution"
                                  : fmt::format("for a voxel size of {:.2g} m",
                                                1.05 * double(frame.spacing_m.x) * std::cbrt(needed / memory.limit));
  if (lattice.levels() > 1) {
    throw Error(scene,
                fmt::format("a grid of {:.3g} vertices on {} levels, {:.4g} m apart on the finest, needs {:.1f} GiB to "
                            "bake and {:.1f} GiB may be used",
                            double(lattice.vertex_count()), lattice.levels(), frame.spacing_m.x, needed / gib,
                            memory.limit / gib),
                "ask " + coarser + ", or for a part of the scene");
  }
  throw Error(
      scene,
      fmt::format("a grid of {}x{}x{} = {:.3g} vertices, {:.4g} m apart, needs {:.1f} GiB to bake and {:.1f} GiB "
                  "may be used",
                  frame.size.x, frame.size.y, frame.size.z, double(frame.vertex_count()), frame.spacing_m.x,
                  needed / gib, memory.limit / gib),
      "ask " + coarser + ", or for a part of the scene");
}

}  // namespace

double memory_limit_bytes(const GridBakeParams& params) {
  return params.max_memory_bytes != 0 ? double(params.max_memory_bytes) : 0.75 * available_memory_bytes();
}

double grid_memory_bytes(const Lattice& lattice, const GridBakeParams& params, int threads) {
  const BakeMemory memory = bake_memory(lattice, params, max_fine_bits);
  return memory.shared + memory.own * threads;
}

void check_grid_memory(const Scene& scene, const Lattice& lattice, const GridBakeParams& params) {
  check(scene.name, lattice, params, bake_memory(lattice, params, 0));
}

int affordable_threads(const LitScene& lit, const Lattice& lattice, const GridBakeParams& params) {
  const int threads = params.threads > 0 ? params.threads : tbb::this_task_arena::max_concurrency();
  const Lights::PhotonPower power = lit.lights.emission(emission_target(lattice.finest_frame(), params)).photon_power();
  const BakeMemory memory = bake_memory(lattice, params, fine_bits(power));
  check(lit.scene->name, lattice, params, memory);
  return int(std::min(double(threads), (memory.limit - memory.shared) / memory.own));
}

}  // namespace ivory
