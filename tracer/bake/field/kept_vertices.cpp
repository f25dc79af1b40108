#include "tracer/bake/field/kept_vertices.h"

#include <algorithm>
#include <cmath>

namespace ivory {
namespace {

// Marks the cells that hold points of the triangle, taken at most half a voxel apart. Coordinates are
// shifted by one half, so that vertex i's cell is [i, i + 1).
void mark_triangle(const V3f& a, const V3f& b, const V3f& c, const GridFrame& frame, std::vector<bool>& marked) {
  const float longest = std::max({(b - a).length(), (c - a).length(), (c - b).length()});
  const auto steps = std::max(1, static_cast<int>(std::ceil(longest * 2)));
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; j <= steps - i; ++j) {
      const V3f p = a + (b - a) * (static_cast<float>(i) / static_cast<float>(steps)) +
                    (c - a) * (static_cast<float>(j) / static_cast<float>(steps));
      V3i cell;
      for (unsigned axis = 0; axis < 3; ++axis)
        cell[axis] = std::clamp(static_cast<int>(std::floor(p[axis])), 0, frame.size[axis] - 1);
      marked[frame.vertex_index(cell.x, cell.y, cell.z)] = true;
    }
  }
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
  for (unsigned corner = 0; corner < 8; ++corner)
    box.extendBy(frame.to_index({(corner & 1U) != 0 ? region.max.x : region.min.x,
                                 (corner & 2U) != 0 ? region.max.y : region.min.y,
                                 (corner & 4U) != 0 ? region.max.z : region.min.z}));
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
      return frame.to_index(mesh.positions[vertex] * instance.to_world) + V3f(0.5F, 0.5F, 0.5F);
    };
    for (const auto& t : mesh.triangles) mark_triangle(index_of(t.x), index_of(t.y), index_of(t.z), frame, marked);
  }
  for (unsigned axis = 0; axis < 3; ++axis) marked = spread(marked, frame, axis, guard_band_voxels);
  for (const Box3f& region : dynamic_regions) mark_region(region, frame, marked);
  return marked;
}

}  // namespace ivory
