#include "grid/field/batch/corners.h"

#include <algorithm>

#include "grid/field/batch/corner_lanes.h"

namespace ivory {

namespace {

constexpr std::uint32_t all_corners = 0xFF;

// Numbers of the vertices of one point in a finer level, 0 for those that are not stored; answers which are.
std::uint32_t find_vertices(const BrickLevel& level, const V3i& base, std::size_t point, Corners& out) {
  if ((base.x & 3) != 3 && (base.y & 3) != 3 && (base.z & 3) != 3) {  // all in one brick
    const std::uint32_t first = level.vertex_at(base);
    const bool is_stored = first < no_brick;
    for (std::uint32_t c = 0; c < 8; ++c)
      out.vertex[c][point] = is_stored ? first + ((c & 1U) | (c >> 1U & 1U) << 2U | (c >> 2U) << 4U) : 0;
    return is_stored ? all_corners : 0;
  }
  std::uint32_t stored = 0;
  for (std::uint32_t c = 0; c < 8; ++c) {
    const std::uint32_t vertex = level.vertex_at(base + V3i(int(c & 1U), int(c >> 1U & 1U), int(c >> 2U)));
    out.vertex[c][point] = vertex < no_brick ? vertex : 0;
    if (vertex < no_brick) stored |= 1U << c;
  }
  return stored;
}

// Weights where some vertices are not stored: as make_brick_footprint().
void share_out(std::size_t point, Corners& out) {
  float sum = 0;
  for (std::size_t c = 0; c < 8; ++c) {
    if ((out.stored[point] >> c & 1U) == 0) out.weight[c][point] = 0;
    sum += out.weight[c][point];
  }
  if (!(sum > 0)) out.stored[point] = 0;
  for (std::size_t c = 0; c < 8; ++c) out.weight[c][point] = sum > 0 ? out.weight[c][point] / sum : 0;
}

}  // namespace

EightPoints make_points(std::span<const LookupPoint* const> points) {
  EightPoints out;
  out.nudge_voxels = points[0]->nudge_voxels;
  for (std::size_t i = 0; i < points_at_once; ++i) {
    const LookupPoint& at = *points[std::min(i, points.size() - 1)];
    for (unsigned axis = 0; axis < 3; ++axis) {
      out.p[axis][i] = at.p[axis];
      out.ng[axis][i] = at.ng[axis];
    }
    out.most_m[i] = at.most_m;
  }
  return out;
}

Corners make_corners(const IrradianceGrid& grid, int level, const EightPoints& points) {
  const GridFrame& frame = grid.frame_of(level);
  const lanes::Vector index = lanes::nudged_index(frame, points);
  lanes::Vector base;
  std::array<std::array<Lanes, 2>, 3> weight;
  std::array<LaneInts, 3> whole;
  Corners out;
  out.level = level;
  for (unsigned axis = 0; axis < 3; ++axis) {  // axis_footprint()
    const int size = frame.size[axis];
    const Lanes clamped = lanes::clamp(index[axis], 0, static_cast<float>(size - 1));
    whole[axis] = stdx::min(stdx::static_simd_cast<LaneInts>(clamped), LaneInts(size - 2));
    base[axis] = stdx::static_simd_cast<Lanes>(whole[axis]);
    const Lanes t = clamped - base[axis];
    weight[axis] = {1 - t, t};
  }
  lanes::store(index, out.index);
  lanes::store(base, out.base);
  for (std::size_t c = 0; c < 8; ++c)
    lanes::store(weight[2][c >> 2U] * weight[1][c >> 1U & 1U] * weight[0][c & 1U], out.weight[c]);
  if (level == 0) {
    const auto row = std::uint32_t(frame.size.x);
    const std::uint32_t slice = row * std::uint32_t(frame.size.y);
    const auto words = [&](unsigned axis) { return stdx::static_simd_cast<LaneWords>(whole[axis]); };
    const LaneWords first = words(2) * slice + words(1) * row + words(0);
    for (std::uint32_t c = 0; c < 8; ++c) {
      const LaneWords vertex = first + ((c >> 2U) * slice + (c >> 1U & 1U) * row + (c & 1U));
      vertex.copy_to(out.vertex[c].data(), stdx::element_aligned);
    }
    out.stored.fill(all_corners);
  } else {
    const BrickLevel& bricks = grid.finer[std::size_t(level - 1)];
    for (std::size_t i = 0; i < points_at_once; ++i) {
      const V3i at(whole[0][i], whole[1][i], whole[2][i]);
      out.stored[i] = find_vertices(bricks, at, i, out);
      if (out.stored[i] != all_corners) share_out(i, out);
    }
  }
  for (std::size_t c = 0; c < 8; ++c) {
    for (std::size_t i = 0; i < points_at_once; ++i)
      out.fraction[c][i] = (out.stored[i] >> c & 1U) != 0 ? grid.visible_fraction[out.vertex[c][i]] : 0;
  }
  out.kept.fill(1);
  return out;
}

void restrict_corners(const Eight<std::uint32_t>& visible, Corners& corners) {
  const LaneWords bits(visible.data(), stdx::element_aligned);
  std::array<LaneMask, 8> seen;
  for (std::size_t c = 0; c < 8; ++c) seen[c] = stdx::static_simd_cast<Lanes>(bits >> int(c) & 1U) != 0;
  lanes::restrict_weights(seen, corners);
}

Footprint footprint_of(const Corners& corners, std::size_t point) {
  Footprint out;
  if (corners.stored[point] == all_corners) {
    for (std::size_t c = 0; c < 8; ++c) {
      out.vertex[c] = corners.vertex[c][point];
      out.weight[c] = corners.weight[c][point];
    }
    out.count = 8;
    return out;
  }
  for (std::size_t c = 0; c < 8; ++c) {
    if ((corners.stored[point] >> c & 1U) == 0) continue;
    out.vertex[std::size_t(out.count)] = corners.vertex[c][point];
    out.weight[std::size_t(out.count++)] = corners.weight[c][point];
  }
  return out;
}

}  // namespace ivory
