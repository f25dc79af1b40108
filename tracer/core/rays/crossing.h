// Where a line meets a triangle, in arithmetic that has the same bits on every CPU.
#pragma once

#include <array>
#include <optional>

#include "grid/base/types.h"

namespace ivory {

// A line made ready to be crossed: seen along itself, with the axis that it runs along most as depth.
struct Line {
  V3d origin;
  V3d shear;  // x and y of the direction over its depth, and 1 over its depth
  std::array<int, 3> axis{};
};
// `direction` must not be zero.
Line make_line(const V3f& origin, const V3f& direction);

struct Crossing {
  double t = 0;  // along the line, in lengths of its direction
  double u = 0;  // weights of the triangle's 2nd and 3rd corner, at least 0 and at most 1 in sum
  double v = 0;
};

// None where the line passes the triangle, lies in its plane, or the triangle has no area. Edges and corners belong to
// the triangle, and no line slips through between triangles that share corners. Unlike Embree's, whose last bits differ
// with the vector instructions that it finds.
std::optional<Crossing> crossing(const Line& line, const std::array<V3f, 3>& corners);

}  // namespace ivory
