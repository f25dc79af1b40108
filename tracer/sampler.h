// Random numbers that depend on nothing but (seed, purpose, index): Random123's Philox 4x32-10,
// keyed by the seed and counted by stream. A photon or a pixel therefore draws the same numbers
// whichever thread runs it, and whatever ran before.
#pragma once

#include <array>
#include <cstdint>

#include "grid/types.h"

namespace ivory {

enum class StreamPurpose : std::uint32_t { photon = 1, pixel = 2, probe = 3, visibility = 4, test = 5, gather = 6 };

class RandomStream {
 public:
  RandomStream(std::uint64_t seed, StreamPurpose purpose, std::uint64_t index)
      : seed_(seed), index_(index), purpose_(static_cast<std::uint32_t>(purpose)) {}

  // 32 uniform bits.
  std::uint32_t next_u32() {
    if (used_ == 4) refill();
    return block_[used_++];
  }
  // Uniform in [0, 1), 24 bits.
  float next() { return static_cast<float>(next_u32() >> 8U) * 0x1p-24F; }
  V2f next2() {
    const float u = next();
    return {u, next()};
  }

 private:
  void refill();

  std::uint64_t seed_;
  std::uint64_t index_;
  std::uint32_t purpose_;
  std::uint32_t block_count_ = 0;
  std::uint32_t used_ = 4;
  std::array<std::uint32_t, 4> block_{};
};

}  // namespace ivory
