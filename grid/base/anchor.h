// Places far from the world's origin. A float holds a position to 2^-24 of its size, half a metre at the coordinates of
// national grids, and rays start farther still from where they are meant to. So what stands far out is kept relative to
// an anchor of doubles beside it: a local position plus the anchor is the world's. Files, command lines and results
// speak of the world; everything that traces and looks up is local.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "grid/base/types.h"

namespace ivory {

inline V3f to_local(const V3d& p_world, const V3d& anchor_m) { return V3f(p_world - anchor_m); }
inline V3d to_world(const V3f& p_local, const V3d& anchor_m) { return V3d(p_local) + anchor_m; }

// The anchor for what fills a ball of that centre and radius, in the world, metres. Zero, so that nothing changes,
// where its own size calls for such coordinates (its centre lies within two radii of the origin), or where rays start
// next to nothing off their surfaces (offset_origin(): 2^-17 of the coordinate): at most a millimetre, and at most a
// thousandth of the radius. Otherwise near the centre, in round numbers: a multiple of 1, 2 or 5 times a power of ten,
// not below the ball's diameter, so that the same things moved by a round distance mostly have the same local
// positions.
V3d choose_anchor(const V3d& center_m, double radius_m);

// The distance between neighbouring floats at that coordinate.
inline float float_step(float coordinate) {
  const float size = std::abs(coordinate);
  return std::nextafter(size, std::numeric_limits<float>::infinity()) - size;
}

}  // namespace ivory
