#include "grid/base/placement.h"

#include <array>
#include <cmath>

namespace ivory {

namespace {

using Imath::M33d;

// Sine and cosine of degrees, exact at multiples of a quarter.
std::array<double, 2> sine_cosine(double degrees) {
  const double within = std::remainder(degrees, 360.0);
  if (within == 0) return {0, 1};
  if (within == 90) return {1, 0};
  if (within == -90) return {-1, 0};
  if (std::abs(within) == 180) return {0, -1};
  const double angle_rad = within * (std::acos(-1.0) / 180);
  return {std::sin(angle_rad), std::cos(angle_rad)};
}

M33d about_x(double degrees) {
  const auto [s, c] = sine_cosine(degrees);
  return {1, 0, 0, 0, c, s, 0, -s, c};
}
M33d about_y(double degrees) {
  const auto [s, c] = sine_cosine(degrees);
  return {c, 0, -s, 0, 1, 0, s, 0, c};
}
M33d about_z(double degrees) {
  const auto [s, c] = sine_cosine(degrees);
  return {c, s, 0, -s, c, 0, 0, 0, 1};
}

M33d turn_in_double(const Placement& p) {
  return about_x(double(p.turn_deg.x)) * about_z(double(p.turn_deg.z)) * about_y(double(p.turn_deg.y));
}

}  // namespace

M33f turn_about_y(double angle_rad) { return M33f(about_y(angle_rad * (180 / std::acos(-1.0)))); }

M33f turn_of(const Placement& placement) { return M33f(turn_in_double(placement)); }

M44f to_matrix(const Placement& placement) {
  const M33d linear = turn_in_double(placement) * double(placement.scale);
  // p * M = (p - pivot) * linear + pivot + offset
  const V3d pivot(placement.pivot_m);
  const V3d shift = pivot + V3d(placement.offset_m) - pivot * linear;
  M44f m;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) m[row][column] = float(linear[row][column]);
    m[3][row] = float(shift[unsigned(row)]);
  }
  return m;
}

V3f placed(const Placement& placement, const V3f& p) {
  return (p - placement.pivot_m) * placement.scale * turn_of(placement) + placement.pivot_m + placement.offset_m;
}

V3f unplaced(const Placement& placement, const V3f& p) {
  const V3f from_pivot = p - placement.offset_m - placement.pivot_m;
  return from_pivot * turn_of(placement).transposed() / placement.scale + placement.pivot_m;
}

}  // namespace ivory
