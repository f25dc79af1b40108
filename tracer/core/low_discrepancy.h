// Points that fill the unit square evenly, any power of two of them, and yet are random enough for
// unbiased estimates: Sobol' points with hashed Owen scrambling (Burley, "Practical Hash-based Owen
// Scrambling", JCGT 9(4), 2020). Own code: no library of Debian's has them.
#pragma once

#include <array>
#include <cstdint>

namespace ivory {

namespace low_discrepancy {

// Bit 0 becomes bit 31 and so on.
inline std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x << 16U) | (x >> 16U);
  x = ((x & 0x00ff00ffU) << 8U) | ((x & 0xff00ff00U) >> 8U);
  x = ((x & 0x0f0f0f0fU) << 4U) | ((x & 0xf0f0f0f0U) >> 4U);
  x = ((x & 0x33333333U) << 2U) | ((x & 0xccccccccU) >> 2U);
  return ((x & 0x55555555U) << 1U) | ((x & 0xaaaaaaaaU) >> 1U);
}

// Each bit flips by a hash of the bits below it (Laine & Karras 2011, constants by N. Vegdahl). On
// reversed numbers that is Owen's nested uniform scramble.
inline std::uint32_t permute(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeaU;
  x += seed;
  x *= (seed >> 16U) | 1U;
  x ^= x * 0x05526c56U;
  x ^= x * 0x53a22864U;
  return x;
}

// Owen's nested uniform scramble of a 32-bit fraction of [0, 1); `seed` chooses which.
inline std::uint32_t scramble(std::uint32_t x, std::uint32_t seed) {
  return reverse_bits(permute(reverse_bits(x), seed));
}

// Murmur3's finalizer: a bijection whose output bits each depend on all input bits.
inline std::uint32_t hash(std::uint32_t x) {
  x ^= x >> 16U;
  x *= 0x85ebca6bU;
  x ^= x >> 13U;
  x *= 0xc2b2ae35U;
  return x ^ (x >> 16U);
}

}  // namespace low_discrepancy

// Coordinates, 32 bits each, of point `index` in the randomly scrambled and shuffled sequence that `seed`
// names. Different seeds give independent sequences, so that they can serve different purposes of one sample.
inline std::array<std::uint32_t, 2> sobol_point(std::uint32_t index, std::uint32_t seed) {
  using namespace low_discrepancy;
  const std::uint32_t shuffled = scramble(index, hash(seed));
  // The second dimension's direction numbers are those of x + 1, v_k = v_(k-1) ^ (v_(k-1) >> 1): row k of Pascal's
  // triangle modulo 2. C(k, i) is odd where i's bits are among k's, so that digit i is the sum over all k that hold it:
  // one step for each of a place's five bits.
  std::uint32_t digits = shuffled;
  digits ^= (digits >> 1U) & 0x55555555U;
  digits ^= (digits >> 2U) & 0x33333333U;
  digits ^= (digits >> 4U) & 0x0f0f0f0fU;
  digits ^= (digits >> 8U) & 0x00ff00ffU;
  digits ^= (digits >> 16U) & 0x0000ffffU;
  // Both dimensions are reversed numbers, and their scrambles reverse them back.
  return {reverse_bits(permute(shuffled, hash(seed ^ 0xa511e9b3U))),
          reverse_bits(permute(digits, hash(seed ^ 0x63d83595U)))};
}

}  // namespace ivory
