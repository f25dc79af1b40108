#include "tracer/bake/field/placement.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tracer/bake/field/bake_memory.h"
#include "tracer/bake/field/scene_lattice.h"

namespace ivory {
namespace {

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
    for (unsigned axis = 0; axis < 3; ++axis) low[axis] += std::max(0.0F, over[axis] * 0.5F - frame.spacing_m[axis]);
  }
  frame.origin_m = middle + frame.direction_to_world(low);
  return frame;
}

std::optional<EmissionTarget> emission_target(const GridFrame& frame, const GridBakeParams& params) {
  if (params.emission == EmissionMode::even) return std::nullopt;
  const V3f size = V3f(frame.size);
  return EmissionTarget{frame.to_world((size - V3f(1, 1, 1)) * 0.5F), (size * frame.spacing_m).length() * 0.5F,
                        bool(params.include_direct)};
}

Lattice default_lattice(const Scene& scene, const GridBakeParams& params) {
  const GridFrame frame = params.frame ? *params.frame : default_frame(scene, params);
  if (params.levels == 1) return frame;
  constexpr double gib = 1024.0 * 1024 * 1024;
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

std::uint64_t default_photons(std::size_t vertices) {
  constexpr std::uint64_t a_vertex = 256;
  constexpr std::uint64_t least = 1'000'000;
  return std::max(least, a_vertex * vertices);
}

}  // namespace ivory
