#include "tracer/bake/field/kept_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ivory {
namespace {

// Marks the cells that hold points of the triangle, taken at most half a voxel apart; points outside count for the
// outermost cells, which answer there. Coordinates are shifted by one half, so that vertex i's cell is [i, i + 1).
//
// The triangle is halved until its corners, drawn to the grid's box, lie so near each other; drawing to the box keeps
// order along each axis, so its other points lie between them. However far it reaches outside, the work goes by what it
// marks.
void mark_triangle(const std::array<V3d, 3>& corners, const GridFrame& frame, std::vector<bool>& marked) {
  constexpr double apart = 0.5;
  std::array<V3d, 3> drawn;
  for (std::size_t i = 0; i < 3; ++i) {
    for (int axis = 0; axis < 3; ++axis)
      drawn[i][axis] = std::clamp(corners[i][axis], 0.0, static_cast<double>(frame.size[axis]));
  }
  double longest = 0;
  std::size_t from = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const V3d edge = drawn[(i + 1) % 3] - drawn[i];
    const double length = std::max({std::abs(edge.x), std::abs(edge.y), std::abs(edge.z)});
    if (length > longest) {
      longest = length;
      from = i;
    }
  }
  if (longest <= apart) {
    for (const V3d& p : drawn) {
      V3i cell;
      for (int axis = 0; axis < 3; ++axis) cell[axis] = std::min(static_cast<int>(p[axis]), frame.size[axis] - 1);
      marked[frame.vertex_index(cell.x, cell.y, cell.z)] = true;
    }
    return;
  }
  const std::size_t to = (from + 1) % 3;
  const V3d middle = (corners[from] + corners[to]) * 0.5;
  std::array<V3d, 3> half = corners;
  half[to] = middle;
  mark_triangle(half, frame, marked);
  half = corners;
  half[from] = middle;
  mark_triangle(half, frame, marked);
}

// Spreads marks by `reach` vertices along one axis: three passes make a cube.
std::vector<bool> spread(const std::vector<bool>& marked, const GridFrame& frame, unsigned axis, int reach) {
  std::vector<bool> out(marked.size());
  V3i at;
  for (at.z = 0; at.z < frame.size.z; ++at.z) {
    for (at.y = 0; at.y < frame.size.y; ++at.y) {
      for (at.x = 0; at.x < frame.size.x; ++at.x) {
        if (!marked[frame.vertex_index(at.x, at.y, at.z)]) continue;
        V3i near = at;
        const int last = std::min(at[axis] + reach, frame.size[axis] - 1);
        for (near[axis] = std::max(at[axis] - reach, 0); near[axis] <= last; ++near[axis])
          out[frame.vertex_index(near.x, near.y, near.z)] = true;
      }
    }
  }
  return out;
}

// Conservative: the box around the region's corners in the grid's own axes.
void mark_region(const Box3f& region, const GridFrame& frame, std::vector<bool>& marked) {
  Box3f box;
  for (unsigned corner = 0; corner < 8; ++corner) {
    box.extendBy(frame.to_index({(corner & 1U) != 0 ? region.max.x : region.min.x,
                                 (corner & 2U) != 0 ? region.max.y : region.min.y,
                                 (corner & 4U) != 0 ? region.max.z : region.min.z}));
  }
  V3i first;
  V3i last;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const auto most = static_cast<float>(frame.size[axis] - 1);
    first[axis] = static_cast<int>(std::clamp(std::floor(box.min[axis]), 0.0F, most));
    last[axis] = static_cast<int>(std::clamp(std::ceil(box.max[axis]), 0.0F, most));
  }
  for (int k = first.z; k <= last.z; ++k) {
    for (int j = first.y; j <= last.y; ++j) {
      for (int i = first.x; i <= last.x; ++i) marked[frame.vertex_index(i, j, k)] = true;
    }
  }
}

}  // namespace

std::vector<bool> kept_vertices(const Scene& scene, const GridFrame& frame, const std::vector<Box3f>& dynamic_regions) {
  std::vector<bool> marked(frame.vertex_count());
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    const auto index_of = [&](std::uint32_t vertex) {
      return V3d(frame.to_index(mesh.positions[vertex] * instance.to_world)) + V3d(0.5, 0.5, 0.5);
    };
    for (const auto& t : mesh.triangles) mark_triangle({index_of(t.x), index_of(t.y), index_of(t.z)}, frame, marked);
  }
  for (unsigned axis = 0; axis < 3; ++axis) marked = spread(marked, frame, axis, guard_band_voxels);
  for (const Box3f& region : dynamic_regions) mark_region(region, frame, marked);
  return marked;
}

}  // namespace ivory
