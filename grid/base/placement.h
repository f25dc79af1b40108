// How an object stands: scaled and turned about a point of its own, then moved.
#pragma once

#include "grid/base/types.h"

namespace ivory {

inline constexpr double radians_a_degree = 3.14159265358979323846 / 180;

struct Placement {
  V3f offset_m{0, 0, 0};  // moves it last
  V3f turn_deg{0, 0,
               0};  // about +X by x, then about +Z by z, then about +Y by y, each counter-clockwise seen from there
  float scale = 1;  // of all lengths alike; above 0
  V3f pivot_m{0, 0, 0};  // what turning and scaling leave where it is

  bool operator==(const Placement&) const = default;
  // Does it stay upright: turned about +Y alone, or not at all?
  bool upright() const { return turn_deg.x == 0 && turn_deg.z == 0; }
};

// A turn about +Y as a matrix of row vectors: v * turn_about_y(angle_rad), which takes +Z to +X at a quarter of a turn.
M33f turn_about_y(double angle_rad);

// The turn alone, of row vectors. Composed in double; quarters of a turn are exact.
M33f turn_of(const Placement& placement);

// p_world = p * to_matrix(placement). The identity for a placement that changes nothing.
M44f to_matrix(const Placement& placement);

// A point of the object where it stands, and back.
V3f placed(const Placement& placement, const V3f& p);
V3f unplaced(const Placement& placement, const V3f& p);

}  // namespace ivory
