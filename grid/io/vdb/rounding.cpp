#include "grid/io/vdb/rounding.h"

#include <array>
#include <cmath>

#include "grid/base/half.h"

namespace ivory {

std::vector<float> rounded_to_noise(std::span<const float> moments, std::span<const Rgb> variance) {
  constexpr double share = 0.25;  // of the standard error
  std::vector<float> out(moments.begin(), moments.end());
  const std::size_t stride = variance.empty() ? 0 : moments.size() / variance.size();
  for (std::size_t vertex = 0; vertex < variance.size(); ++vertex) {
    std::array<float, 3> step{};
    for (unsigned c = 0; c < 3; ++c) {
      const double error = std::sqrt(double(variance[vertex][c]));
      // Below 2^-100 lux products with its inverse would leave what floats hold.
      if (error > 0x1p-98) step[c] = std::ldexp(1.0F, std::ilogb(share * error));
    }
    for (std::size_t i = 0; i < stride; ++i) {
      float& x = out[vertex * stride + i];
      const float h = step[i % 3];
      constexpr float most_steps = 0x1p24F;  // beyond, a float has no finer step itself
      if (h > 0 && std::abs(x) < most_steps * h) x = std::nearbyint(x / h) * h;
    }
  }
  return out;
}

Rgb rounded_variance(const Rgb& variance) {
  Rgb out;
  for (unsigned c = 0; c < 3; ++c) {
    int exponent = 0;
    const float mantissa = std::frexp(variance[c], &exponent);
    out[c] = std::ldexp(std::nearbyint(mantissa * 128), exponent - 7);
  }
  return out;
}

void HalfCheck::add(float x) {
  constexpr float most = 65504;
  // Below this halves lose bits without any bound.
  constexpr float least = 0x1p-14F;
  const float magnitude = std::abs(x);
  ++count_;
  if (magnitude > most) beyond_ = true;
  const float half = rounded_to_half(x);
  if (half == x) return;
  ++inexact_;
  if (magnitude < least) beyond_ = true;
}

}  // namespace ivory
