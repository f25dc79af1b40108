#include "tracer/bake/field/scene_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "grid/base/error.h"

namespace ivory {
namespace {

using Triangle = std::array<V3d, 3>;  // in double: of a large plane one corner may lie a million voxels away

// Does the triangle meet the box? Separating axes: the box's three normals, the triangle's, and the nine products of
// edges (Akenine-Moller, "Fast 3D Triangle-Box Overlap Testing", JGT 2001).
bool meets(const Triangle& triangle, const V3d& center, const V3d& half) {
  const Triangle v{triangle[0] - center, triangle[1] - center, triangle[2] - center};
  const auto parted = [&](const V3d& axis) {
    const double a = axis.dot(v[0]);
    const double b = axis.dot(v[1]);
    const double c = axis.dot(v[2]);
    const double reach = half.x * std::abs(axis.x) + half.y * std::abs(axis.y) + half.z * std::abs(axis.z);
    return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
  };
  const std::array<V3d, 3> edges{v[1] - v[0], v[2] - v[1], v[0] - v[2]};
  if (parted({1, 0, 0}) || parted({0, 1, 0}) || parted({0, 0, 1}) || parted(edges[0].cross(edges[1]))) return false;
  for (const V3d& e : edges) {
    if (parted({0, -e.z, e.y}) || parted({e.z, 0, -e.x}) || parted({-e.y, e.x, 0})) return false;
  }
  return true;
}

V3i brick_count(const GridFrame& level) { return (level.size + V3i(3, 3, 3)) / brick_side; }
std::size_t brick_index(const V3i& b, const V3i& bricks) {
  return (std::size_t(b.z) * std::size_t(bricks.y) + std::size_t(b.y)) * std::size_t(bricks.x) + std::size_t(b.x);
}

std::vector<V3i> list(const std::vector<std::uint8_t>& marked, const V3i& bricks) {
  std::vector<V3i> out;
  V3i at;
  for (at.z = 0; at.z < bricks.z; ++at.z) {
    for (at.y = 0; at.y < bricks.y; ++at.y) {
      for (at.x = 0; at.x < bricks.x; ++at.x) {
        if (marked[brick_index(at, bricks)] != 0) out.push_back(at);
      }
    }
  }
  return out;
}

// Calls visit(brick) for the bricks first .. last - 1 that the triangle comes within reach of: halves of the box are
// asked until they are single bricks, so that a large triangle costs no more than the bricks along it.
template <typename Visit>
void for_each_brick(const Triangle& triangle, float reach, const V3i& first, const V3i& last, const Visit& visit) {
  const V3i size = last - first;
  if (size.x <= 0 || size.y <= 0 || size.z <= 0) return;
  const V3d half = V3d(size) * (0.5 * brick_side);
  if (!meets(triangle, V3d(first) * double(brick_side) + half, half + V3d(reach, reach, reach))) return;
  const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  if (size[axis] == 1) return visit(first);
  V3i middle_last = last;
  V3i middle_first = first;
  middle_last[axis] = middle_first[axis] = first[axis] + size[axis] / 2;
  for_each_brick(triangle, reach, first, middle_last, visit);
  for_each_brick(triangle, reach, middle_first, last, visit);
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

// Calls visit(triangle, brick) for all of them; triangles in index coordinates shifted by half a voxel.
template <typename Visit>
void for_each_near(const Scene& scene, const GridFrame& level, float reach_voxels, const Visit& visit) {
  const V3i bricks = brick_count(level);
  const V3f reach(reach_voxels, reach_voxels, reach_voxels);
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    const auto index_of = [&](std::uint32_t vertex) {
      return V3d(level.to_index(mesh.positions[vertex] * instance.to_world)) + V3d(0.5, 0.5, 0.5);
    };
    for (const auto& t : mesh.triangles) {
      const Triangle triangle{index_of(t.x), index_of(t.y), index_of(t.z)};
      Box3f box;
      for (const V3d& p : triangle) box.extendBy(V3f(p));
      const auto range = brick_range(box.min - reach, box.max + reach, bricks);
      for_each_brick(triangle, reach_voxels, range[0], range[1], [&](const V3i& brick) { visit(triangle, brick); });
    }
  }
}

}  // namespace

std::vector<V3i> bricks_near_surfaces(const Scene& scene, const GridFrame& level, float reach_voxels) {
  const V3i bricks = brick_count(level);
  std::vector<std::uint8_t> marked(brick_index({0, 0, bricks.z}, bricks), 0);
  for_each_near(scene, level, reach_voxels,
                [&](const Triangle& /*triangle*/, const V3i& brick) { marked[brick_index(brick, bricks)] = 1; });
  return list(marked, bricks);
}

NearVertices::NearVertices(const Scene& scene, const GridFrame& level, float reach_voxels)
    : bricks_(brick_count(level)), marks_(brick_index({0, 0, bricks_.z}, bricks_), 0) {
  const V3d half(reach_voxels, reach_voxels, reach_voxels);
  for_each_near(scene, level, reach_voxels, [&](const Triangle& triangle, const V3i& brick) {
    std::uint64_t& marks = marks_[brick_index(brick, bricks_)];
    for (int i = 0; i < brick_vertices; ++i) {
      if ((marks >> i & 1U) != 0) continue;
      const V3d vertex = V3d(brick * brick_side + V3i(i & 3, i >> 2 & 3, i >> 4)) + V3d(0.5, 0.5, 0.5);
      if (meets(triangle, vertex, half)) marks |= std::uint64_t(1) << i;
    }
  });
}

std::vector<NearVertices> vertices_near_surfaces(const Scene& scene, const Lattice& lattice, float reach_voxels) {
  std::vector<NearVertices> out;
  out.reserve(lattice.levels());
  for (int level = 0; level < lattice.levels(); ++level) out.emplace_back(scene, lattice.frame_of(level), reach_voxels);
  return out;
}

std::vector<V3i> bricks_in_boxes(const std::vector<Box3f>& boxes, const GridFrame& level) {
  const V3i bricks = brick_count(level);
  std::vector<std::uint8_t> marked(brick_index({0, 0, bricks.z}, bricks), 0);
  for (const Box3f& region : boxes) {
    Box3f box;  // around its corners in the grid's own axes
    for (unsigned corner = 0; corner < 8; ++corner) {
      box.extendBy(level.to_index({(corner & 1U) != 0 ? region.max.x : region.min.x,
                                   (corner & 2U) != 0 ? region.max.y : region.min.y,
                                   (corner & 4U) != 0 ? region.max.z : region.min.z}) +
                   V3f(0.5F, 0.5F, 0.5F));
    }
    const auto range = brick_range(box.min, box.max, bricks);
    V3i at;
    for (at.z = range[0].z; at.z < range[1].z; ++at.z) {
      for (at.y = range[0].y; at.y < range[1].y; ++at.y) {
        for (at.x = range[0].x; at.x < range[1].x; ++at.x) marked[brick_index(at, bricks)] = 1;
      }
    }
  }
  return list(marked, bricks);
}

Lattice make_scene_lattice(const Scene& scene, const GridFrame& finest, const SceneLatticeParams& params) {
  if (params.levels < 1 || params.levels > max_levels)
    throw ParameterError("levels", fmt::format("there may be 1 to {} of them", max_levels));
  if (params.levels == 1) return finest;
  const int multiple = 1 << params.levels;
  for (int axis = 0; axis < 3; ++axis) {
    if (finest.size[axis] % multiple != 0) {
      throw ParameterError(
          "levels", fmt::format("{} of them need a multiple of {} vertices along each axis", params.levels, multiple));
    }
  }
  std::vector<std::vector<V3i>> bricks(std::size_t(params.levels - 1));
  const GridFrame coarsest = coarser_frame(finest, params.levels - 1);
  // As the lattice will have it: its origin is rounded on the way down.
  GridFrame level = coarsest;
  for (int i = 1; i < params.levels; ++i) level = finer_frame(level);
  bricks.back() = bricks_near_surfaces(scene, level, params.reach_voxels);
  const std::vector<V3i> moved = bricks_in_boxes(params.dynamic_regions, level);
  bricks.back().insert(bricks.back().end(), moved.begin(), moved.end());
  return make_lattice(coarsest, bricks);
}

}  // namespace ivory
