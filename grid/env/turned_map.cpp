#include "grid/env/turned_map.h"

#include <cmath>

namespace ivory {

EnvironmentMap turned(const EnvironmentMap& map, double turn_deg) {
  // u = 1/2 - angle / 2 pi, with the angle from +Z towards +X: what is shown at u stood at u + turn / 2 pi before.
  const double columns = turn_deg / 360 * map.width;
  double whole = std::floor(columns);
  double rest = columns - whole;
  // Rounding is no fraction of a column.
  if (rest > 1 - 1e-6) whole += 1;
  if (rest < 1e-6 || rest > 1 - 1e-6) rest = 0;
  const auto column = [&](double c) {
    const double width = map.width;
    return std::size_t(c - std::floor(c / width) * width) % std::size_t(map.width);
  };
  EnvironmentMap out = map;
  for (int x = 0; x < map.width; ++x) {
    const std::size_t a = column(x + whole);
    const std::size_t b = column(x + whole + 1);
    for (int y = 0; y < map.height; ++y) {
      const std::size_t row = std::size_t(y) * std::size_t(map.width);
      Rgb& texel = out.radiance[row + std::size_t(x)];
      texel = map.radiance[row + a];
      if (rest > 0) texel = texel * float(1 - rest) + map.radiance[row + b] * float(rest);
    }
  }
  return out;
}

}  // namespace ivory
