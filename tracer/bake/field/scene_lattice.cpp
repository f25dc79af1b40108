#include "tracer/bake/field/scene_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "grid/base/error.h"

namespace ivory {
namespace {

using Triangle = std::array<V3f, 3>;

// Does the triangle meet the box? Separating axes: the box's three normals, the triangle's, and the nine products of
// edges (Akenine-Moller, "Fast 3D Triangle-Box Overlap Testing", JGT 2001).
bool meets(const Triangle& triangle, const V3f& center, const V3f& half) {
  const Triangle v{triangle[0] - center, triangle[1] - center, triangle[2] - center};
  const auto parted = [&](const V3f& axis) {
    const float a = axis.dot(v[0]);
    const float b = axis.dot(v[1]);
    const float c = axis.dot(v[2]);
    const float reach = half.x * std::abs(axis.x) + half.y * std::abs(axis.y) + half.z * std::abs(axis.z);
    return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
  };
  const std::array<V3f, 3> edges{v[1] - v[0], v[2] - v[1], v[0] - v[2]};
  if (parted({1, 0, 0}) || parted({0, 1, 0}) || parted({0, 0, 1}) || parted(edges[0].cross(edges[1]))) return false;
  for (const V3f& e : edges) {
    if (parted({0, -e.z, e.y}) || parted({e.z, 0, -e.x}) || parted({-e.y, e.x, 0})) return false;
  }
  return true;
}

// Marks the bricks first .. last - 1 that the triangle comes within reach of: halves of the box are asked until they
// are single bricks, so that a large triangle costs no more than the bricks along it.
void mark(const Triangle& triangle, float reach, const V3i& first, const V3i& last, BrickMarks& marks) {
  const V3i size = last - first;
  if (size.x <= 0 || size.y <= 0 || size.z <= 0) return;
  const V3f half = V3f(size) * (0.5F * brick_side);
  if (!meets(triangle, V3f(first) * float(brick_side) + half, half + V3f(reach, reach, reach))) return;
  const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  if (size[axis] == 1) {
    marks.marked[marks.index(first)] = 1;
    return;
  }
  V3i middle_last = last;
  V3i middle_first = first;
  middle_last[axis] = middle_first[axis] = first[axis] + size[axis] / 2;
  mark(triangle, reach, first, middle_last, marks);
  mark(triangle, reach, middle_first, last, marks);
}

// The bricks from `low` to `high` in index coordinates shifted by half a voxel, as far as there are any.
std::array<V3i, 2> brick_range(const V3f& low, const V3f& high, const V3i& bricks) {
  std::array<V3i, 2> range;
  for (int axis = 0; axis < 3; ++axis) {
    const auto end = float(bricks[axis]);
    range[0][axis] = int(std::clamp(std::floor(low[axis] / brick_side), 0.0F, end));
    range[1][axis] = int(std::clamp(std::floor(high[axis] / brick_side) + 1, 0.0F, end));
  }
  return range;
}

}  // namespace

BrickMarks::BrickMarks(const GridFrame& level) {
  for (int axis = 0; axis < 3; ++axis) bricks[axis] = (level.size[axis] + brick_side - 1) / brick_side;
  marked.assign(index({0, 0, bricks.z}), 0);
}

std::vector<V3i> BrickMarks::list() const {
  std::vector<V3i> out;
  V3i at;
  for (at.z = 0; at.z < bricks.z; ++at.z) {
    for (at.y = 0; at.y < bricks.y; ++at.y) {
      for (at.x = 0; at.x < bricks.x; ++at.x) {
        if (marked[index(at)] != 0) out.push_back(at);
      }
    }
  }
  return out;
}

std::vector<BrickMarks> bricks_near_surfaces(const Scene& scene, const Lattice& lattice, float reach_voxels) {
  std::vector<BrickMarks> out;
  for (int level = 0; level < lattice.levels(); ++level)
    out.push_back(bricks_near_surfaces(scene, lattice.frame_of(level), reach_voxels));
  return out;
}

BrickMarks bricks_near_surfaces(const Scene& scene, const GridFrame& level, float reach_voxels) {
  BrickMarks marks(level);
  const V3f reach(reach_voxels, reach_voxels, reach_voxels);
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    const auto index_of = [&](std::uint32_t vertex) {
      return level.to_index(mesh.positions[vertex] * instance.to_world) + V3f(0.5F, 0.5F, 0.5F);
    };
    for (const auto& t : mesh.triangles) {
      const Triangle triangle{index_of(t.x), index_of(t.y), index_of(t.z)};
      Box3f box;
      for (const V3f& p : triangle) box.extendBy(p);
      const auto range = brick_range(box.min - reach, box.max + reach, marks.bricks);
      mark(triangle, reach_voxels, range[0], range[1], marks);
    }
  }
  return marks;
}

std::vector<V3i> bricks_in_boxes(const std::vector<Box3f>& boxes, const GridFrame& level) {
  BrickMarks marks(level);
  for (const Box3f& region : boxes) {
    Box3f box;  // around its corners in the grid's own axes
    for (unsigned corner = 0; corner < 8; ++corner) {
      box.extendBy(level.to_index({(corner & 1U) != 0 ? region.max.x : region.min.x,
                                   (corner & 2U) != 0 ? region.max.y : region.min.y,
                                   (corner & 4U) != 0 ? region.max.z : region.min.z}) +
                   V3f(0.5F, 0.5F, 0.5F));
    }
    const auto range = brick_range(box.min, box.max, marks.bricks);
    V3i at;
    for (at.z = range[0].z; at.z < range[1].z; ++at.z) {
      for (at.y = range[0].y; at.y < range[1].y; ++at.y) {
        for (at.x = range[0].x; at.x < range[1].x; ++at.x) marks.marked[marks.index(at)] = 1;
      }
    }
  }
  return marks.list();
}

Lattice make_scene_lattice(const Scene& scene, const GridFrame& finest, const SceneLatticeParams& params) {
  if (params.levels < 1 || params.levels > max_levels)
    throw ParameterError("levels", fmt::format("there may be 1 to {} of them", max_levels));
  if (params.levels == 1) return finest;
  const int multiple = 1 << params.levels;
  for (int axis = 0; axis < 3; ++axis) {
    if (finest.size[axis] % multiple != 0)
      throw ParameterError(
          "levels", fmt::format("{} of them need a multiple of {} vertices along each axis", params.levels, multiple));
  }
  std::vector<std::vector<V3i>> bricks(std::size_t(params.levels - 1));
  const GridFrame coarsest = coarser_frame(finest, params.levels - 1);
  // As the lattice will have it: its origin is rounded on the way down.
  GridFrame level = coarsest;
  for (int i = 1; i < params.levels; ++i) level = finer_frame(level);
  bricks.back() = bricks_near_surfaces(scene, level, params.reach_voxels).list();
  const std::vector<V3i> moved = bricks_in_boxes(params.dynamic_regions, level);
  bricks.back().insert(bricks.back().end(), moved.begin(), moved.end());
  return make_lattice(coarsest, bricks);
}

}  // namespace ivory
