// The guard by stored planes for eight points at once: visible_by_guard() of guard.cpp, yield_near() of yield.cpp and
// read_near() of lookup.cpp, whose comments say why, lane by lane.
#include <algorithm>

#include "grid/field/batch/corner_lanes.h"
#include "grid/field/guard.h"
#include "grid/field/lookup.h"
#include "grid/field/yield.h"

namespace ivory {
namespace {

using lanes::Vector;
using Masks = std::array<LaneMask, 8>;  // by corner
const LaneMask none(false);

// The planes of a vertex each.
struct Planes {
  std::array<kernels::Plane<Lanes>, guard_planes> plane;
  std::array<LaneMask, guard_planes> is_set;
  std::array<bool, guard_planes> any_set;

  LaneMask sees(const Vector& u) const {
    LaneMask hidden = none;
    for (std::size_t k = 0; k < guard_planes; ++k) {
      if (any_set[k]) hidden = hidden || (is_set[k] && plane[k].beyond(u) > 0);
    }
    return !hidden;
  }
};

Planes unpack(const IrradianceGrid& grid, const Eight<std::uint32_t>& vertex) {
  Planes out;
  for (std::size_t k = 0; k < guard_planes; ++k) {
    const LaneWords word([&](auto lane) { return grid.guard[vertex[lane]].words[k]; });
    const auto number = [](const LaneWords& bits) {
      return stdx::static_simd_cast<Lanes>(stdx::static_simd_cast<LaneInts>(bits));
    };
    const Lanes distance = number(word >> 20);
    out.is_set[k] = distance > 0;
    out.any_set[k] = stdx::any_of(out.is_set[k]);
    if (out.any_set[k]) out.plane[k] = kernels::plane_of(number(word & 1023U), number(word >> 10 & 1023U), distance);
  }
  return out;
}

// What is known of the vertices whatever point they are read from.
struct Vertices {
  std::array<Planes, 8> planes;
  Masks lit;
};

// is_lit().
LaneMask lit_lanes(const IrradianceGrid& grid, const Corners& corners, std::size_t c) {
  const auto stride = std::size_t(grid.stride());
  const Eight<std::uint32_t>& vertex = corners.vertex[c];
  const Lanes first([&](auto lane) { return grid.moments[vertex[lane] * stride]; });
  const LaneMask seeing = lanes::load(corners.fraction[c]) > 0;
  LaneMask lit = seeing && first != 0;
  if (stdx::all_of(lit == seeing)) return lit;
  for (std::size_t i = 0; i < points_at_once; ++i) {
    if (seeing[i] && !lit[i]) lit[i] = is_lit(grid, vertex[i]);
  }
  return lit;
}

Vertices know_vertices(const IrradianceGrid& grid, const Corners& corners) {
  Vertices out;
  for (std::size_t c = 0; c < 8; ++c) {
    out.planes[c] = unpack(grid, corners.vertex[c]);
    out.lit[c] = lit_lanes(grid, corners, c);
  }
  return out;
}

// From corner c to an index position.
Vector offset_from(const Vector& base, std::size_t c, const Vector& index) {
  return {index[0] - (base[0] + float(c & 1U)), index[1] - (base[1] + float(c >> 1U & 1U)),
          index[2] - (base[2] + float(c >> 2U))};
}

struct Seen {
  Masks visible;
  Masks in_front;
};

// visible_by_guard() before anything gives way.
Seen see(const IrradianceGrid& grid, const EightPoints& points, const Corners& corners, const Vertices& vertices) {
  const GridFrame& frame = grid.frame_of(corners.level);
  const V3f& spacing = frame.spacing_m;
  const Vector index = lanes::load(corners.index);
  const Vector base = lanes::load(corners.base);
  const Vector ng = lanes::load(points.ng);
  Vector facing = lanes::direction_to_local(frame, ng);
  for (unsigned axis = 0; axis < 3; ++axis) facing[axis] = facing[axis] * spacing[int(axis)];
  const Lanes behind_m =
      lanes::off_m(frame, points, points.nudge_voxels) + in_plane_voxels * std::min({spacing.x, spacing.y, spacing.z});
  const LaneMask at_surface = ng[0] != 0 || ng[1] != 0 || ng[2] != 0;
  Seen out;
  for (std::size_t c = 0; c < 8; ++c) {
    const LaneMask counts = lanes::load(corners.weight[c]) != 0 && lanes::load(corners.fraction[c]) > 0;
    const Vector u = offset_from(base, c, index);
    const LaneMask behind = facing[0] * u[0] + facing[1] * u[1] + facing[2] * u[2] > behind_m;
    out.in_front[c] = counts && at_surface && !behind;
    out.visible[c] = counts && vertices.planes[c].sees(u);
  }
  return out;
}

// yield_near(): what is left of `seen.visible`.
Masks yield(const IrradianceGrid& grid, const Corners& corners, const Vertices& vertices, const Seen& seen) {
  Masks left = seen.visible;
  std::array<Lanes, 8> trusted;
  LaneMask give_way = none;
  for (std::size_t c = 0; c < 8; ++c) {
    trusted[c] = lanes::load(corners.weight[c]) * lanes::trust(corners.fraction[c]);
    give_way = give_way || (left[c] && vertices.lit[c] && seen.in_front[c] && trusted[c] >= least_weight);
  }
  for (std::size_t c = 0; c < 8; ++c) left[c] = left[c] && (vertices.lit[c] || !give_way);

  LaneMask doubtful = none;
  Lanes most = least_weight;
  Lanes witness = -1.0F;
  for (std::size_t c = 0; c < 8; ++c) {
    doubtful = doubtful || (left[c] && !seen.in_front[c]);
    const LaneMask heavier = left[c] && seen.in_front[c] && trusted[c] > most;
    most = select(heavier, trusted[c], most);
    witness = select(heavier, Lanes(float(c)), witness);
  }
  const LaneMask asked = doubtful && witness >= 0;
  if (stdx::none_of(asked)) return left;
  Eight<std::uint32_t> vertex;
  Vector from;
  for (std::size_t i = 0; i < points_at_once; ++i) {
    const std::size_t c = asked[i] ? std::size_t(witness[i]) : 0;
    vertex[i] = corners.vertex[c][i];
    from[0][i] = float(c & 1U);
    from[1][i] = float(c >> 1U & 1U);
    from[2][i] = float(c >> 2U);
  }
  const Planes planes = unpack(grid, vertex);
  for (std::size_t c = 0; c < 8; ++c) {
    const LaneMask judged = asked && left[c] && !seen.in_front[c];
    if (stdx::none_of(judged)) continue;
    left[c] =
        left[c] &&
        (!judged || planes.sees({float(c & 1U) - from[0], float(c >> 1U & 1U) - from[1], float(c >> 2U) - from[2]}));
  }
  return left;
}

// see_too() of lookup.cpp: do those that were read see the point closer to the surface as well?
LaneMask see_too(const IrradianceGrid& grid, const EightPoints& points, const Corners& near, const Vertices& vertices) {
  const GridFrame& frame = grid.frame_of(near.level);
  const Vector index = lanes::index_of(frame, points, lanes::off_m(frame, points, points.nudge_voxels * closer_share));
  const Vector base = lanes::load(near.base);
  const Lanes kept = lanes::load(near.kept);
  LaneMask any_lit = none;
  LaneMask any_sees = none;
  LaneMask all_see(true);
  for (std::size_t c = 0; c < 8; ++c) {
    const LaneMask counts = lanes::load(near.weight[c]) * kept >= least_weight;
    const LaneMask sees = vertices.planes[c].sees(offset_from(base, c, index));
    any_lit = any_lit || (counts && vertices.lit[c]);
    any_sees = any_sees || (counts && sees);
    all_see = all_see && (sees || !counts);
  }
  return (any_lit && any_sees) || (!any_lit && all_see);
}

void put(const Corners& from, std::size_t point, Corners& to) {
  for (unsigned axis = 0; axis < 3; ++axis) {
    to.index[axis][point] = from.index[axis][point];
    to.base[axis][point] = from.base[axis][point];
  }
  for (std::size_t c = 0; c < 8; ++c) {
    to.vertex[c][point] = from.vertex[c][point];
    to.weight[c][point] = from.weight[c][point];
    to.fraction[c][point] = from.fraction[c][point];
  }
  to.stored[point] = from.stored[point];
  to.kept[point] = from.kept[point];
}

}  // namespace

Corners read_near(const IrradianceGrid& grid, int level, const EightPoints& points) {
  Corners near = make_corners(grid, level, points);
  const Vertices vertices = know_vertices(grid, near);
  lanes::restrict_weights(yield(grid, near, vertices, see(grid, points, near, vertices)), near);
  const Vector ng = lanes::load(points.ng);
  const LaneMask at_surface = ng[0] != 0 || ng[1] != 0 || ng[2] != 0;
  if (points.nudge_voxels == 0) return near;
  const LaneMask again = at_surface && !(lanes::load(near.kept) > 0 && see_too(grid, points, near, vertices));
  if (stdx::none_of(again)) return near;
  EightPoints closer = points;
  closer.nudge_voxels *= closer_share;
  Corners second = make_corners(grid, level, closer);
  const Vertices others = know_vertices(grid, second);
  lanes::restrict_weights(yield(grid, second, others, see(grid, closer, second, others)), second);
  for (std::size_t i = 0; i < points_at_once; ++i) {
    if (again[i] && second.kept[i] > 0) put(second, i, near);
  }
  return near;
}

}  // namespace ivory
