// A deposit as integers: its rounding, and adding it to a thread's 32-bit sums or to the 64-bit ones that all share.
// Private to the depositor.
//
// Where lights of very different power shine, deposits too small for the coarse unit are counted in quanta
// instead, 2^fine_bits times smaller, and rounded at random: x becomes floor(x) + 1 with probability x - floor(x) and
// else floor(x), whose mean is x however small it is. Rounding to the nearest would turn x < 1/2 into 0 each time, a
// bias that no number of photons removes. It adds at most 1/4 quantum^2 to a deposit's variance. The random numbers
// are hashed from the segment itself, whose jitter is uniform and which no batch or thread changes.
#pragma once

#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <thread>

#include "tracer/render/photons/tracer.h"

namespace ivory {

inline constexpr std::int32_t spill_limit = 1 << 30;
inline constexpr float largest_step = 1 << 24;  // larger deposits go to the shared sums at once

// Rounds to the nearest for |value| < 2^24; compiles to vector conversions, which lrint does not.
inline std::int32_t rounded(float value) { return static_cast<std::int32_t>(value + std::copysign(0.5F, value)); }

// Deposits of less than this many coarse units are counted in quanta, of which they are then less than largest_step.
inline float fine_below(int fine_bits) { return fine_bits == 0 ? 0.0F : std::ldexp(largest_step, -fine_bits); }

// An integer hash of little bias (Wellons, "Prospecting for Hash Functions", 2018).
inline std::uint32_t mixed(std::uint32_t x) {
  x ^= x >> 16U;
  x *= 0x7feb352dU;
  x ^= x >> 15U;
  x *= 0x846ca68bU;
  return x ^ (x >> 16U);
}

// Random bits of a segment, for rounded_at_random(): the same for the same segment, whoever deposits it.
inline std::uint32_t rounding_key(const PhotonSegment& segment) {
  std::uint32_t key = 0;
  for (const float x : {segment.jitter, segment.direction.x, segment.direction.y, segment.origin.x, segment.origin.z})
    key = mixed(key ^ std::bit_cast<std::uint32_t>(x)) + 0x9e3779b9U;
  return key;
}

// Rounds coarse units to whole quanta at random.
inline std::int32_t rounded_at_random(float value, int fine_bits, std::uint32_t key, std::size_t lane) {
  const double quanta = std::ldexp(double(value), fine_bits);
  const double whole = std::floor(quanta);
  const std::uint32_t u = mixed(key + 0x9e3779b9U * static_cast<std::uint32_t>(lane + 1));
  return static_cast<std::int32_t>(whole) + (double(u) < (quanta - whole) * 0x1p32 ? 1 : 0);
}

// A thread's own sums of a slot of a vertex fill whole cache lines, so that a deposit touches as few as can be: the
// lanes are padded to 16 or 32 numbers of 32 bits. Their values are padded to whole vectors of four.
inline constexpr std::size_t cell_lanes(std::size_t lanes) { return (lanes + 15) / 16 * 16; }
inline constexpr std::size_t value_lanes(std::size_t lanes) { return (lanes + 3) / 4 * 4; }

// Vectors of four and eight lanes by hand (GCC and Clang's vector extension): both compilers unroll plain loops into
// scalars. Unsigned, because the test for the limit is meant to wrap.
using UInt4 [[gnu::vector_size(16)]] = std::uint32_t;
using UInt8 [[gnu::vector_size(32)]] = std::uint32_t;

// Adds steps to cells, and finds out afterwards whether sums have come near overflow: up to steps_between_checks of
// them may go by until then, as none adds 2^24 and the limit lies 64 times that below what 32 bits hold.
inline constexpr std::size_t steps_between_checks = 60;
template <int lanes>
class CellAdder {
 public:
  void add(std::int32_t* cell, const std::int32_t* values) {
    std::size_t i = 0;
    for (; i + 8 <= used; i += 8) add_at(cell + i, values + i, outside8_);
    if constexpr (used % 8 != 0) add_at(cell + i, values + i, outside4_);
  }
  // Whether some sum passed the limit since the last call.
  bool passed_limit() {
    std::uint32_t any = 0;
    for (std::size_t i = 0; i < 8; ++i) any |= outside8_[i];
    for (std::size_t i = 0; i < 4; ++i) any |= outside4_[i];
    outside8_ = UInt8{};
    outside4_ = UInt4{};
    return (any >> 31U) != 0;
  }

 private:
  static constexpr std::size_t used = value_lanes(lanes);
  template <typename Vector>
  static void add_at(std::int32_t* cell, const std::int32_t* values, Vector& outside) {
    Vector sum;
    Vector value;
    std::memcpy(&sum, cell, sizeof(sum));
    std::memcpy(&value, values, sizeof(value));
    sum += value;
    std::memcpy(cell, &sum, sizeof(sum));
    outside |= sum + std::uint32_t(spill_limit);  // the top bit is set once |sum| passes the limit
  }
  UInt8 outside8_{};
  UInt4 outside4_{};
};

// Has one of a cell's sums come near overflow?
inline bool is_past_limit(const std::int32_t* cell, std::size_t lanes) {
  std::uint32_t any = 0;
  for (std::size_t i = 0; i < lanes; ++i) any |= std::uint32_t(cell[i]) + std::uint32_t(spill_limit);
  return (any >> 31U) != 0;
}

inline void atomic_add(std::int64_t& target, std::int64_t value) {
  std::atomic_ref<std::int64_t>(target).fetch_add(value, std::memory_order_relaxed);
}

// The first lane of a slot stands for its lock: `taken` while a thread holds it, which no sum comes to (add_wide()).
inline constexpr std::int64_t taken = std::numeric_limits<std::int64_t>::min();

inline std::int64_t take(std::int64_t& first_lane) {
  for (int tries = 0;; ++tries) {
    const std::int64_t sum = std::atomic_ref<std::int64_t>(first_lane).exchange(taken, std::memory_order_acquire);
    if (sum != taken) return sum;
    if (tries > 100) std::this_thread::yield();  // its holder may have been put to sleep
  }
}

inline void put_back(std::int64_t& first_lane, std::int64_t sum) {
  std::atomic_ref<std::int64_t>(first_lane).store(sum, std::memory_order_release);
}

// One thread at a time adds to a slot of a vertex: who finds its first lane there takes it out until the others are
// written. So the lock costs no memory and no cache line of its own.
template <int lanes>
inline void add_shared(std::int64_t* sums, const std::int32_t* values, int unit_bits) {
  const std::int64_t first = take(sums[0]);
  for (std::size_t i = 1; i < lanes; ++i) sums[i] += std::int64_t(values[i]) << unit_bits;
  put_back(sums[0], first + (std::int64_t(values[0]) << unit_bits));
}

}  // namespace ivory
