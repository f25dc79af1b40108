#include "grid/export/texel.h"

#include <algorithm>
#include <cmath>

#include <half.h>

namespace ivory {

std::uint16_t pack_half(float x) { return half(std::clamp(x, -largest_half, largest_half)).bits(); }

float unpack_half(std::uint16_t bits) {
  half h;
  h.setBits(bits);
  return h;
}

std::uint32_t pack_shared_exponent(const Rgb& colour) {
  constexpr int bits = 9;
  constexpr int bias = 15;
  const auto clamped = [](float c) { return std::clamp(c, 0.0F, largest_shared_exponent); };
  const std::array<float, 3> c{clamped(colour.x), clamped(colour.y), clamped(colour.z)};
  const float most = std::max({c[0], c[1], c[2]});
  int exponent = most > 0 ? std::max(-bias - 1, std::ilogb(most)) + 1 + bias : 0;
  const auto mantissa = [&](float x) {
    return std::uint32_t(std::floor(std::ldexp(x, bits + bias - exponent) + 0.5F));
  };
  if (mantissa(most) == 1U << bits) ++exponent;
  return std::uint32_t(exponent) << 27U | mantissa(c[2]) << 18U | mantissa(c[1]) << 9U | mantissa(c[0]);
}

Rgb unpack_shared_exponent(std::uint32_t word) {
  const int exponent = int(word >> 27U) - 24;
  const auto channel = [&](unsigned shift) { return std::ldexp(float(word >> shift & 0x1FFU), exponent); };
  return {channel(0), channel(9), channel(18)};
}

namespace {

// A half without sign whose last bits are rounded away.
std::uint32_t shortened(float x, unsigned bits) {
  if (!(x > 0)) return 0;
  const std::uint32_t half_bits = pack_half(x);
  const std::uint32_t most = (0x7BFFU >> bits);  // the exponent 31 stands for infinity
  return std::min((half_bits + (1U << (bits - 1))) >> bits, most);
}

}  // namespace

std::uint32_t pack_float11(const Rgb& colour) {
  return shortened(colour.z, 5) << 22U | shortened(colour.y, 4) << 11U | shortened(colour.x, 4);
}

Rgb unpack_float11(std::uint32_t word) {
  return {unpack_half(std::uint16_t((word & 0x7FFU) << 4U)), unpack_half(std::uint16_t((word >> 11U & 0x7FFU) << 4U)),
          unpack_half(std::uint16_t((word >> 22U & 0x3FFU) << 5U))};
}

}  // namespace ivory
