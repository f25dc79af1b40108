// Where the vertices of an irradiance grid stand in the world.
#pragma once

#include <cstddef>
#include <cstdint>

#include "grid/base/types.h"

namespace ivory {

// Vertices stand at integer index coordinates 0 .. size-1, each in the middle of its cell, the box of one voxel around
// it: the grid covers index coordinates -1/2 .. size-1/2. Index (i, j, k) lies at origin_m + (i spacing_m.x, j
// spacing_m.y, k spacing_m.z) * local_to_world (Imath row vectors).
struct GridFrame {
  V3i size{0, 0, 0};       // vertices per axis, each at least 2
  V3f origin_m{0, 0, 0};   // world position of vertex (0, 0, 0)
  V3f spacing_m{1, 1, 1};  // along the grid's own axes
  M33f local_to_world;     // rotation; rows are the grid's axes in world space. Stored vectors live in the local frame

  bool operator==(const GridFrame&) const = default;

  std::size_t vertex_count() const { return std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z); }
  // The number of the vertex at (i, j, k), below vertex_count(); x runs fastest.
  std::size_t vertex_index(int i, int j, int k) const {
    return (std::size_t(k) * std::size_t(size.y) + std::size_t(j)) * std::size_t(size.x) + std::size_t(i);
  }
  // And back: the index coordinates of that vertex. The number is below 2^32.
  V3i vertex_coordinates(std::size_t vertex) const {
    const auto row = std::uint32_t(vertex) / std::uint32_t(size.x);
    return {int(std::uint32_t(vertex) % std::uint32_t(size.x)), int(row % std::uint32_t(size.y)),
            int(row / std::uint32_t(size.y))};
  }

  // Between world positions in metres and index coordinates.
  V3f to_index(const V3f& p_world) const { return direction_to_local(p_world - origin_m) / spacing_m; }
  V3f to_world(const V3f& p_index) const { return origin_m + direction_to_world(p_index * spacing_m); }
  // Does some vertex's cell hold the position? To a thousandth of a voxel, as surfaces may lie in the grid's faces.
  bool covers(const V3f& p_world) const {
    const V3f index = to_index(p_world);
    constexpr float half = 0.501F;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(index[axis] >= -half && index[axis] <= float(size[axis] - 1) + half)) return false;
    }
    return true;
  }

  // Between world axes and the grid's own; lengths stay. local_to_world is a rotation: its transpose is its inverse.
  V3f direction_to_local(const V3f& w) const {
    const M33f& m = local_to_world;
    return {w.x * m[0][0] + w.y * m[0][1] + w.z * m[0][2], w.x * m[1][0] + w.y * m[1][1] + w.z * m[1][2],
            w.x * m[2][0] + w.y * m[2][1] + w.z * m[2][2]};
  }
  V3f direction_to_world(const V3f& w) const { return w * local_to_world; }
};

}  // namespace ivory
