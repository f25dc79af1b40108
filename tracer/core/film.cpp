#include "tracer/core/film.h"

#include <algorithm>
#include <cmath>

namespace ivory {

float auto_exposure(const Film& film) {
  std::vector<float> lit;
  double sum = 0;
  for (const Rgb& pixel : film.pixels) {
    const float y = luminance(pixel);
    if (!(y > 0)) continue;
    lit.push_back(y);
    sum += std::log2(double(y));
  }
  if (lit.empty()) return 0;
  const auto bright = lit.begin() + std::ptrdiff_t(lit.size() * 9 / 10);
  std::nth_element(lit.begin(), bright, lit.end());
  return float(std::min(std::log2(0.18) - sum / double(lit.size()), -std::log2(double(*bright))));
}

// https://github.com/KhronosGroup/ToneMapping: the constants are those of its specification.
Rgb tone_map(const Rgb& linear) {
  constexpr float start = 0.8F - 0.04F;
  constexpr float desaturation = 0.15F;
  const float least = std::min({linear.x, linear.y, linear.z});
  const float offset = least < 0.08F ? least - 6.25F * least * least : 0.04F;
  Rgb color = linear - Rgb(offset, offset, offset);
  const float peak = max_component(color);
  if (peak < start) return color;
  const float range = 1 - start;
  const float new_peak = 1 - range * range / (peak + range - start);
  color *= new_peak / peak;
  const float white = 1 - 1 / (desaturation * (peak - new_peak) + 1);
  return color * (1 - white) + Rgb(new_peak, new_peak, new_peak) * white;
}

}  // namespace ivory
