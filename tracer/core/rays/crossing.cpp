#include "tracer/core/rays/crossing.h"

#include <algorithm>
#include <cmath>

namespace ivory {
namespace {

__extension__ using Quad = __float128;  // 113 bits: holds the product of two doubles

// A corner as the line sees it: x and y across, z in depth.
V3d seen(const Line& line, const V3f& corner) {
  const V3d from_origin = V3d(corner) - line.origin;
  const double depth = from_origin[line.axis[2]];
  return {from_origin[line.axis[0]] - line.shear.x * depth, from_origin[line.axis[1]] - line.shear.y * depth, depth};
}

// Twice the area, with a sign, between the line and the edge from p to q. The sign is exact: what one triangle at an
// edge takes for outside the other takes for inside, and around a corner one of them has the line.
double side(const V3d& p, const V3d& q) {
  const double left = p.x * q.y;
  const double right = p.y * q.x;
  const double area = left - right;
  // Each product is off by at most 2^-53 of itself.
  if (std::abs(area) > 0x1p-51 * (std::abs(left) + std::abs(right))) return area;
  return static_cast<double>(static_cast<Quad>(p.x) * static_cast<Quad>(q.y) -
                             static_cast<Quad>(p.y) * static_cast<Quad>(q.x));
}

}  // namespace

Line make_line(const V3f& origin, const V3f& direction) {
  Line line;
  line.origin = V3d(origin);
  const V3f size(std::abs(direction.x), std::abs(direction.y), std::abs(direction.z));
  const int depth = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  line.axis = {(depth + 1) % 3, (depth + 2) % 3, depth};
  const V3d d(direction);
  line.shear = {d[line.axis[0]] / d[depth], d[line.axis[1]] / d[depth], 1 / d[depth]};
  return line;
}

// Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013: each corner is rounded once on its
// way into the line's own plane, and what is asked there of three edges is exact.
std::optional<Crossing> crossing(const Line& line, const std::array<V3f, 3>& corners) {
  const V3d a = seen(line, corners[0]);
  const V3d b = seen(line, corners[1]);
  const V3d c = seen(line, corners[2]);
  const double of_a = side(c, b);
  const double of_b = side(a, c);
  if ((of_a < 0 && of_b > 0) || (of_a > 0 && of_b < 0)) return std::nullopt;
  const double of_c = side(b, a);
  if (std::min({of_a, of_b, of_c}) < 0 && std::max({of_a, of_b, of_c}) > 0) return std::nullopt;
  const double sum = of_a + of_b + of_c;
  if (sum == 0) return std::nullopt;
  Crossing out;
  out.u = of_b / sum;
  out.v = of_c / sum;
  // Of the point that the weights make, which lies between the corners whatever was rounded.
  out.t = (a.z * (of_a / sum) + b.z * out.u + c.z * out.v) * line.shear.z;
  return out;
}

}  // namespace ivory
