// What the sources of batch/ do with the lanes of eight points and their corners.
#pragma once

#include "grid/field/batch/corners.h"
#include "grid/field/batch/lanes.h"
#include "grid/field/kernels.h"

namespace ivory::lanes {

using Vector = kernels::Triple<Lanes>;

inline Lanes load(const EightFloats& from) { return to_lanes(from.data()); }
inline Vector load(const std::array<EightFloats, 3>& from) { return {load(from[0]), load(from[1]), load(from[2])}; }
inline void store(const Lanes& from, EightFloats& to) { from.copy_to(to.data(), stdx::element_aligned); }
inline void store(const Vector& from, std::array<EightFloats, 3>& to) {
  for (unsigned axis = 0; axis < 3; ++axis) store(from[axis], to[axis]);
}

inline Lanes clamp(const Lanes& x, float low, float high) {
  return select(x < low, Lanes(low), select(high < x, Lanes(high), x));
}

// GridFrame::direction_to_local().
inline Vector direction_to_local(const GridFrame& frame, const Vector& w) {
  const M33f& m = frame.local_to_world;
  Vector out;
  for (int axis = 0; axis < 3; ++axis) out[unsigned(axis)] = w[0] * m[axis][0] + w[1] * m[axis][1] + w[2] * m[axis][2];
  return out;
}

// LookupPoint::off_m() with a share of the nudge.
inline Lanes off_m(const GridFrame& frame, const EightPoints& points, float nudge_voxels) {
  const V3f& h = frame.spacing_m;
  return kernels::smaller(Lanes(nudge_voxels * std::min({h.x, h.y, h.z})), load(points.most_m));
}

// Index coordinates of the points off the surface.
inline Vector index_of(const GridFrame& frame, const EightPoints& points, const Lanes& off) {
  const Vector p = load(points.p);
  const Vector ng = load(points.ng);
  Vector from_origin;
  for (unsigned axis = 0; axis < 3; ++axis) from_origin[axis] = p[axis] + ng[axis] * off - frame.origin_m[int(axis)];
  Vector out = direction_to_local(frame, from_origin);
  for (unsigned axis = 0; axis < 3; ++axis) out[axis] = out[axis] / frame.spacing_m[int(axis)];
  return out;
}
inline Vector nudged_index(const GridFrame& frame, const EightPoints& points) {
  return index_of(frame, points, off_m(frame, points, points.nudge_voxels));
}

inline Lanes trust(const EightFloats& fraction) {
  constexpr float full_trust = 0.25F;  // vertex_trust()
  return kernels::smaller(Lanes(1.0F), load(fraction) / full_trust);
}

// restrict_footprint().
inline void restrict_weights(const std::array<LaneMask, 8>& seen, Corners& corners) {
  std::array<Lanes, 8> trusted;
  Lanes kept = 0.0F;
  for (std::size_t c = 0; c < 8; ++c) {
    trusted[c] = load(corners.weight[c]) * select(seen[c], trust(corners.fraction[c]), Lanes(0.0F));
    kept += trusted[c];
  }
  const LaneMask nothing = kept < least_weight;
  for (std::size_t c = 0; c < 8; ++c) {
    const Lanes weight = load(corners.weight[c]);
    store(select(nothing, weight, trusted[c] / kept), corners.weight[c]);
  }
  store(select(nothing, Lanes(0.0F), kept), corners.kept);
}

}  // namespace ivory::lanes
