// Eight numbers side by side: what kernels of look-ups are written for, once for float and once for these. Only sources
// of batch/ include this; numbers of lanes are equal to those of single floats to the last bit, as each is an operation
// of IEEE 754 by itself and nothing is contracted.
#pragma once

#include <cmath>
#include <cstdint>

#include <experimental/simd>

namespace ivory {

inline constexpr int lane_count = 8;

namespace stdx = std::experimental;
using Lanes = stdx::simd<float, stdx::simd_abi::deduce_t<float, lane_count>>;
using LaneMask = Lanes::mask_type;
using LaneInts = stdx::rebind_simd_t<std::int32_t, Lanes>;
using LaneWords = stdx::rebind_simd_t<std::uint32_t, Lanes>;

inline Lanes select(const LaneMask& which, const Lanes& yes, const Lanes& no) {
  Lanes out = no;
  where(which, out) = yes;
  return out;
}
inline Lanes to_lanes(const float* eight) { return Lanes(eight, stdx::element_aligned); }

}  // namespace ivory
