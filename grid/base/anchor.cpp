#include "grid/base/anchor.h"

namespace ivory {
namespace {

// The least of 1, 2 and 5 times a power of ten that is not below `length`.
double round_step(double length) {
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  for (const double digit : {1.0, 2.0, 5.0}) {
    if (digit * power >= length) return digit * power;
  }
  return 10 * power;
}

}  // namespace

V3d choose_anchor(const V3d& center_m, double radius_m) {
  constexpr double longest_offset_m = 1e-3;
  constexpr double longest_offset_of_radius = 1e-3;
  const double far_m = std::max({std::abs(center_m.x), std::abs(center_m.y), std::abs(center_m.z)});
  if (!(radius_m > 0) || !std::isfinite(far_m) || !std::isfinite(radius_m)) return V3d(0, 0, 0);
  const double offset_m = far_m * 0x1p-17;
  if (far_m <= 2 * radius_m || (offset_m <= longest_offset_m && offset_m <= longest_offset_of_radius * radius_m))
    return V3d(0, 0, 0);
  const double step = round_step(2 * radius_m);
  const auto rounded = [&](double x) { return std::round(x / step) * step + 0.0; };  // no -0
  return V3d(rounded(center_m.x), rounded(center_m.y), rounded(center_m.z));
}

}  // namespace ivory
