// Colours as the texels that graphics cards read.
#pragma once

#include <array>
#include <cstdint>

#include "grid/base/types.h"

namespace ivory {

inline constexpr float largest_half = 65504;
inline constexpr float largest_shared_exponent = 65408;
inline constexpr float largest_float11 = 64512;  // of the blue channel, which has the fewest bits

// IEEE halves, rounded to nearest even; beyond the largest the largest.
std::uint16_t pack_half(float x);
float unpack_half(std::uint16_t bits);

// E5B9G9R9: nine bits a channel and one exponent (Vulkan 1.3 section 3.11.2, "sharedexp"); red in the lowest bits.
// Negative is 0, beyond the largest the largest.
std::uint32_t pack_shared_exponent(const Rgb& colour);
Rgb unpack_shared_exponent(std::uint32_t word);

// R11F_G11F_B10F: floats of five bits of exponent and six, six, five of mantissa; red in the lowest bits. Negative is
// 0, beyond the largest the largest.
std::uint32_t pack_float11(const Rgb& colour);
Rgb unpack_float11(std::uint32_t word);

}  // namespace ivory
