#include "tracer/bake/field/baker.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "tracer/bake/field/guard_fit.h"
#include "tracer/bake/field/kept_vertices.h"
#include "tracer/bake/field/lit_vertices.h"
#include "tracer/bake/field/photon_deposit.h"
#include "tracer/bake/field/scene_lattice.h"
#include "tracer/bake/field/vertex_visibility.h"
#include "tracer/render/photon_tracer.h"

namespace ivory {
namespace {

constexpr int default_long_side = 32;
constexpr std::uint64_t default_photons_a_vertex = 256;
constexpr std::uint64_t least_default_photons = 1'000'000;
constexpr std::uint64_t scout_photons_a_vertex = 4;
constexpr std::uint64_t photons_a_batch = 2048;  // about 10,000 segments: they stay in the second-level cache

// A local coordinate in the world, as the command line takes it.
std::string text_of(float x, double anchor) {
  return anchor == 0 ? fmt::format("{}", x) : fmt::format("{:.12g}", double(x) + anchor);
}

// "-1,0,2:3,4,5 ..." as the command line takes them; "none".
std::string text_of(const std::vector<Box3f>& boxes, const V3d& anchor) {
  std::string text;
  const auto corner = [&](const V3f& p) {
    return fmt::format("{},{},{}", text_of(p.x, anchor.x), text_of(p.y, anchor.y), text_of(p.z, anchor.z));
  };
  for (const Box3f& b : boxes) text += fmt::format("{}{}:{}", text.empty() ? "" : " ", corner(b.min), corner(b.max));
  return text.empty() ? "none" : text;
}

Metadata describe(const Scene& scene, const GridBakeParams& params, const Lattice& lattice, std::uint64_t photons,
                  const SumLayout& layout, const Lights::Emission& emission) {
  Metadata m;
  m["method"] = std::string("irradiance grid");
  m["basis"] = std::string(name_of(params.basis));
  m["estimator"] = std::string(name_of(params.estimator));
  m["guard"] = std::string(params.guard == Guard::off ? "off" : "on");  // rays and planes bake the same
  m["photons"] = static_cast<std::int64_t>(photons);
  m["max_bounces"] = static_cast<std::int64_t>(params.max_bounces);
  m["seed"] = static_cast<std::int64_t>(params.seed);
  m["scene"] = scene.name;
  m["scene_hash"] = scene.content_hash;
  m["dynamic_regions"] =
      params.dynamic_regions ? text_of(*params.dynamic_regions, scene.anchor_m) : std::string("everywhere");
  m["bounds"] = params.bounds ? text_of({*params.bounds}, scene.anchor_m) : std::string("scene");
  m["rotate_y_deg"] = double(params.rotate_y_deg);
  if (lattice.levels() > 1) {
    std::string spacings;
    std::string counts;
    for (int level = 0; level < lattice.levels(); ++level) {
      spacings += fmt::format("{}{:.6g}", level == 0 ? "" : " ", lattice.frame_of(level).spacing_m.x);
      counts += fmt::format("{}{}", level == 0 ? "" : " ", lattice.vertex_count_of(level));
    }
    m["levels"] = std::int64_t(lattice.levels());
    m["level_spacings_m"] = spacings;  // along the grid's x
    m["level_vertices"] = counts;
  }
  m["units"] = std::string("lux");
  m["sum_slots"] = static_cast<std::int64_t>(layout.slots);
  if (const std::vector<double>& radii_m = emission.discs().radii_m; !radii_m.empty()) {
    std::string text;
    for (const double radius_m : radii_m) text += fmt::format("{}{:.6g}", text.empty() ? "" : " ", radius_m);
    m["entry_discs_m"] = text;
    m["photon_power_lm"] = double(emission.photon_power().strongest_lm);
  }
  return m;
}

// Rows are the grid's axes in the world.
M33f axes_turned_about_y(float degrees) {
  M33f axes;
  if (degrees == 0) return axes;
  const double a = double(degrees) * double(pi) / 180;
  axes[0][0] = axes[2][2] = float(std::cos(a));
  axes[2][0] = float(std::sin(a));
  axes[0][2] = -axes[2][0];
  return axes;
}

// Along the axes that are the rows of `axes`.
Box3f bounds_along(const Scene& scene, const M33f& axes) {
  Box3f box;
  const M33f to_axes = axes.transposed();
  for (const Instance& instance : scene.instances) {
    for (const V3f& p : scene.meshes[std::size_t(instance.mesh)].positions)
      box.extendBy((p * instance.to_world) * to_axes);
  }
  return box;
}

}  // namespace

namespace {

// What levels of bricks can tile.
V3i whole_bricks(V3i size, int levels) {
  if (levels <= 1) return size;
  if (levels > max_levels) throw ParameterError("levels", fmt::format("there may be 1 to {} of them", max_levels));
  const int multiple = 1 << levels;
  for (int axis = 0; axis < 3; ++axis) size[axis] = (size[axis] + multiple - 1) / multiple * multiple;
  return size;
}

}  // namespace

GridFrame default_frame(const Scene& scene, const GridBakeParams& params) {
  GridFrame frame;
  frame.local_to_world = axes_turned_about_y(params.rotate_y_deg);
  const bool turned = params.rotate_y_deg != 0;
  const Box3f box = params.bounds ? *params.bounds : turned ? bounds_along(scene, frame.local_to_world) : bounds(scene);
  if (box.isEmpty() || !(box.size().length() > 0))
    throw Error(scene.name, "has no surfaces to place a grid around", "check that the scene's nodes hold meshes");
  // Bounds by hand are turned about their middle, those found along the axes are there already.
  const V3f middle = params.bounds ? box.center() : frame.direction_to_world(box.center());
  V3f extent = box.size();
  const float longest = std::max({extent.x, extent.y, extent.z});
  constexpr float flat_share = 0.05F;
  for (unsigned axis = 0; axis < 3; ++axis) extent[axis] = std::max(extent[axis], longest * flat_share);

  if (params.resolution) {
    frame.size = *params.resolution;
    if (frame.size.x < 2 || frame.size.y < 2 || frame.size.z < 2)
      throw ParameterError("resolution", "a grid needs at least 2 vertices along each axis");
    frame.size = whole_bricks(frame.size, params.levels);
    frame.spacing_m = extent / V3f(frame.size);
  } else {
    const float voxel = params.voxel_size_m.value_or(longest / default_long_side);
    if (!(voxel > 0) || !std::isfinite(voxel))
      throw ParameterError("voxel_size", "it must be a positive number of metres");
    for (unsigned axis = 0; axis < 3; ++axis) {
      // A hair less than one voxel over does not call for another layer of vertices.
      const double count = std::max(2.0, std::ceil(double(extent[axis]) / voxel - 1e-3));
      if (count > 32768) {
        throw ParameterError(
            "voxel_size",
            fmt::format("{:.4g} m makes {:.0f} vertices along {:.4g} m, and 32768 may stand along an axis", voxel,
                        count, extent[axis]));
      }
      frame.size[axis] = static_cast<int>(count);
    }
    frame.size = whole_bricks(frame.size, params.levels);
    frame.spacing_m = V3f(voxel, voxel, voxel);
  }
  // Those of a level of bricks are not all stored, and their bricks are what is numbered.
  const double numbered = double(frame.vertex_count()) / (params.levels > 1 ? brick_vertices : 1);
  if (std::max({frame.size.x, frame.size.y, frame.size.z}) > 32768 || numbered > 0x1p31) {
    throw ParameterError(params.resolution ? "resolution" : "voxel_size",
                         fmt::format("{}x{}x{} are {:.3g} vertices over {:.4g} x {:.4g} x {:.4g} m, more than the 2^31 "
                                     "that a grid may have",
                                     frame.size.x, frame.size.y, frame.size.z, double(frame.vertex_count()), extent.x,
                                     extent.y, extent.z));
  }
  V3f low = (V3f(frame.size) - V3f(1, 1, 1)) * frame.spacing_m * -0.5F;  // of the first vertex, from the middle
  if (params.levels > 1) {
    // What whole bricks stick out by goes to the far sides, but for a voxel: floors and grounds, which lie at the near
    // side along y, then stand clear of the border between two bricks and need one layer of them.
    const V3f over = V3f(frame.size) * frame.spacing_m - extent;
    for (unsigned axis = 0; axis < 3; ++axis)
      low[axis] += std::max(0.0F, over[axis] * 0.5F - frame.spacing_m[axis]);
  }
  frame.origin_m = middle + frame.direction_to_world(low);
  return frame;
}

EmissionTarget emission_target(const GridFrame& frame, const GridBakeParams& params) {
  const V3f size = V3f(frame.size);
  return {frame.to_world((size - V3f(1, 1, 1)) * 0.5F), (size * frame.spacing_m).length() * 0.5F,
          params.include_direct};
}

namespace {

struct BakeMemory {
  double shared = 0;  // by all threads
  double own = 0;     // of each
  double limit = 0;
};

// What the threads share: sums, the grid, and the tables of bricks. Each adds to its own, 4 bytes a lane, twice where
// photons of weak lights have sums of a finer unit, and all sums are there once more while they are sorted; unless
// there are so many that the threads share them.
BakeMemory bake_memory(const Lattice& lattice, const GridBakeParams& params, int fine_bits) {
  const auto vertices = double(lattice.vertex_count());
  const SumLayout layout = sum_layout(params.basis, params.estimator);
  const double sums = vertices * layout.stride();
  const bool own = choose_buffers(lattice.vertex_count(), layout, fine_bits) == DepositBuffers::own;
  const double shared = sums * (own ? 16 : 8) + vertices * (double(function_count(params.basis)) * 12 + 64) +
                        table_bytes(lattice.frame, lattice.levels());
  return {shared, own ? sums * (fine_bits != 0 ? 8 : 4) : 0, memory_limit_bytes(params)};
}

constexpr double gib = 1024.0 * 1024 * 1024;

void check(const std::string& scene, const Lattice& lattice, const GridBakeParams& params, const BakeMemory& memory) {
  const double needed = memory.shared + memory.own;
  if (needed <= memory.limit) return;
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

Lattice default_lattice(const Scene& scene, const GridBakeParams& params) {
  const GridFrame frame = params.frame ? *params.frame : default_frame(scene, params);
  if (params.levels == 1) return frame;
  const double bytes = table_bytes(coarser_frame(frame, params.levels - 1), params.levels);
  if (bytes > memory_limit_bytes(params)) {
    throw Error(
        scene.name,
        fmt::format("the tables of a grid whose finest level has {}x{}x{} vertices, {:.4g} m apart, need {:.1f} "
                    "GiB and {:.1f} GiB may be used",
                    frame.size.x, frame.size.y, frame.size.z, frame.spacing_m.x, bytes / gib,
                    memory_limit_bytes(params) / gib),
        "ask for larger voxels, or for a part of the scene");
  }
  SceneLatticeParams lattice;
  lattice.levels = params.levels;
  if (params.dynamic_regions) lattice.dynamic_regions = *params.dynamic_regions;
  return make_scene_lattice(scene, frame, lattice);
}

void check_grid_memory(const Scene& scene, const Lattice& lattice, const GridBakeParams& params) {
  check(scene.name, lattice, params, bake_memory(lattice, params, 0));
}

int affordable_threads(const LitScene& lit, const Lattice& lattice, const GridBakeParams& params) {
  const int threads = params.threads > 0 ? params.threads : tbb::this_task_arena::max_concurrency();
  const Lights::PhotonPower power = lit.lights.emission(emission_target(lattice.finest_frame(), params)).photon_power();
  const BakeMemory memory = bake_memory(lattice, params, fine_bits(power));
  check(lit.scene->name, lattice, params, memory);
  return memory.own == 0 ? threads : int(std::min(double(threads), (memory.limit - memory.shared) / memory.own));
}

GridAccumulator bake_grid_sums(const LitScene& lit, const GridBakeParams& params) {
  const Scene& scene = *lit.scene;
  if (lit.lights.empty())
    throw Error(scene.name, "nothing in it shines", "add a light, an emissive material or an environment");
  const Lattice lattice = params.lattice ? *params.lattice : default_lattice(scene, params);
  const std::size_t vertices = lattice.vertex_count();
  check_estimator(lattice, params.estimator);
  const SumLayout layout = sum_layout(params.basis, params.estimator);
  const int threads = affordable_threads(lit, lattice, params);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));

  const std::uint64_t photons =
      params.photons != 0 ? params.photons : std::max(least_default_photons, default_photons_a_vertex * vertices);
  const auto range = params.photon_range.value_or(std::pair<std::uint64_t, std::uint64_t>{0, photons});
  const std::uint64_t begin = range.first;  // Clang 14 does not capture structured bindings
  const std::uint64_t end = range.second;
  if (begin >= end || end > photons)
    throw ParameterError("photon_range", "it must be A:B with A below B and B at most the " + std::to_string(photons) +
                                             " photons of the whole bake");

  std::vector<std::uint64_t> masks = params.guard == Guard::off
                                         ? std::vector<std::uint64_t>(vertices, ~std::uint64_t(0))
                                         : vertex_cell_masks(lit.intersector, lattice);
  if (params.dynamic_regions) {
    // Finer levels have bricks only where they are wanted.
    const std::vector<bool> kept = kept_vertices(scene, lattice.frame, *params.dynamic_regions);
    for (std::size_t v = 0; v < kept.size(); ++v) {
      if (!kept[v]) masks[v] = 0;
    }
  }
  std::vector<float> visible_fraction = visible_fractions(masks);
  std::vector<GuardRecord> guard;
  const PhotonTracer tracer(lit, {.max_bounces = params.max_bounces,
                                  .include_direct = params.include_direct,
                                  .seed = params.seed,
                                  .target = emission_target(lattice.finest_frame(), params)});
  if (params.guard != Guard::off) {
    const std::uint64_t scouts = std::min(photons, scout_photons_a_vertex * vertices);
    const std::vector<bool> reached = lit_vertices(tracer, lattice, masks, scouts);
    guard = fit_guard(lit.intersector, lattice, visible_fraction, reached);
  }

  const Lights::PhotonPower power = tracer.emission().photon_power();
  DepositTarget target =
      make_deposit_target(lattice, params.basis, params.estimator, power.strongest_lm, std::move(masks),
                          fine_bits(power), power.heaviest_lm, choose_buffers(vertices, layout, fine_bits(power)));
  struct Worker {
    PhotonDepositor depositor;
    std::vector<PhotonSegment> segments;
    PhotonLedger ledger;
  };
  // One for each of the arena's slots: over time more threads may take part than at once.
  tbb::task_arena arena(threads);
  std::vector<std::unique_ptr<Worker>> workers(static_cast<std::size_t>(threads));
  std::mutex progress_mutex;
  std::uint64_t done = 0;
  const std::uint64_t batches = (end - begin + photons_a_batch - 1) / photons_a_batch;
  const auto trace_batches = [&](const tbb::blocked_range<std::uint64_t>& batch_range) {
    std::unique_ptr<Worker>& own = workers[std::size_t(tbb::this_task_arena::current_thread_index())];
    if (!own) own = std::make_unique<Worker>(Worker{PhotonDepositor(target), {}, {}});
    Worker& worker = *own;
    for (std::uint64_t batch = batch_range.begin(); batch < batch_range.end(); ++batch) {
      const std::uint64_t first = begin + batch * photons_a_batch;
      const std::uint64_t last = std::min(first + photons_a_batch, end);
      worker.segments.clear();
      tracer.trace(first, last, worker.segments, worker.ledger);
      worker.depositor.deposit(worker.segments);
      if (params.progress) {
        const std::lock_guard lock(progress_mutex);
        done += last - first;
        params.progress(done, end - begin);
      }
    }
  };
  arena.execute([&] { tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, batches, 4), trace_batches); });
  PhotonLedger ledger;
  for (const std::unique_ptr<Worker>& worker : workers) {
    if (!worker) continue;
    worker->depositor.flush();
    ledger += worker->ledger;
  }

  workers.clear();
  GridAccumulator result = to_accumulator(std::move(target));
  result.anchor_m = scene.anchor_m;
  result.visible_fraction = std::move(visible_fraction);
  result.guard = std::move(guard);
  result.light = params.include_direct ? StoredLight::direct_and_indirect : StoredLight::indirect;
  result.photon_begin = begin;
  result.photon_end = end;
  result.counters = {{"ledger_emitted", ledger.emitted}, {"ledger_absorbed", ledger.absorbed},
                     {"ledger_escaped", ledger.escaped}, {"ledger_terminated", ledger.terminated},
                     {"photons_traced", ledger.photons}, {"rays_traced", ledger.rays}};
  result.metadata = describe(scene, params, result, photons, layout, tracer.emission());
  result.metadata["ledger_unit_lm"] = tracer.ledger_unit_lm();
  return result;
}

}  // namespace ivory
