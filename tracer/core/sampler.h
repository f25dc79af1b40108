// Random numbers that depend on nothing but (seed, purpose, index): Random123's Philox 4x32-10,
// keyed by the seed and counted by stream. A photon or a pixel therefore draws the same numbers
// whichever thread runs it, and whatever ran before.
#pragma once

#include <array>
#include <cstdint>

#include "grid/base/types.h"
#include "tracer/core/low_discrepancy.h"

namespace ivory {

enum class StreamPurpose : std::uint32_t {
  photon = 1,
  pixel = 2,
  probe = 3,
  visibility = 4,
  test = 5,
  gather = 6,
  capture = 7,
  pilot = 8,
  emitter = 9,
  domain = 16,
  truth = 17
};

class RandomStream {
 public:
  RandomStream(std::uint64_t seed, StreamPurpose purpose, std::uint64_t index)
      : seed_(seed), index_(index), purpose_(static_cast<std::uint32_t>(purpose)) {}

  // Begins sample number `sample` of an estimate: the next `calls` calls of next_u32(), next() and
  // next2() return point `sample` of low-discrepancy sequences, one sequence a call, so that samples 0, 1,
  // 2 ... which make the same calls cover each call's range evenly. Calls after that are independent again.
  // `key` names the family of sequences; any random number.
  void begin_sample(std::uint32_t sample, std::uint32_t key, std::uint32_t calls) {
    sample_ = sample;
    key_ = key;
    in_sample_ = true;
    point_ = sample;
    point_key_ = key;
    low_discrepancy_calls_ = calls;
  }
  // Begins part `part` of the sample: the next `calls` calls have sequences of its own, however many calls the parts
  // before it made. Independent numbers where no sample was begun.
  void begin_part(std::uint32_t part, std::uint32_t calls) {
    point_ = sample_;
    point_key_ = key_ ^ low_discrepancy::hash(part + 1);
    low_discrepancy_calls_ = in_sample_ ? calls : 0;
  }
  // Begins branch i of the n that the sample splits into: all branches of all samples are then numbered
  // through, and share sequences of their own. Independent numbers where no sample was begun. After the
  // last branch end_branches() takes the sample up where branch 0 left it.
  void begin_branch(std::uint32_t i, std::uint32_t n, std::uint32_t calls) {
    if (i == 0) calls_before_branches_ = low_discrepancy_calls_;
    point_ = sample_ * n + i;
    point_key_ = key_ ^ 0x68bc21ebU;
    low_discrepancy_calls_ = in_sample_ ? calls : 0;
  }
  void end_branches() {
    point_ = sample_;
    point_key_ = key_;
    low_discrepancy_calls_ = calls_before_branches_;
  }

  // 32 uniform bits.
  std::uint32_t next_u32() {
    if (low_discrepancy_calls_ != 0) return next_point()[0];
    if (used_ == 4) refill();
    return block_[used_++];
  }
  // Uniform in [0, 1), 24 bits.
  float next() { return to_float(next_u32()); }
  V2f next2() {
    const std::array<std::uint32_t, 2> point = next_pair();
    return {to_float(point[0]), to_float(point[1])};
  }
  // The same, 32 bits each.
  std::array<std::uint32_t, 2> next_pair() {
    if (low_discrepancy_calls_ != 0) return next_point();
    const std::uint32_t u = next_u32();
    return {u, next_u32()};
  }

 private:
  static float to_float(std::uint32_t bits) { return static_cast<float>(bits >> 8U) * 0x1p-24F; }
  std::array<std::uint32_t, 2> next_point() {
    return sobol_point(point_, point_key_ + 0x9e3779b9U * low_discrepancy_calls_--);
  }
  void refill();

  std::uint64_t seed_;
  std::uint64_t index_;
  std::uint32_t purpose_;
  std::uint32_t block_count_ = 0;
  std::uint32_t used_ = 4;
  std::uint32_t sample_ = 0;
  std::uint32_t key_ = 0;
  std::uint32_t point_ = 0;
  std::uint32_t point_key_ = 0;
  bool in_sample_ = false;
  std::uint32_t calls_before_branches_ = 0;
  std::uint32_t low_discrepancy_calls_ = 0;
  std::array<std::uint32_t, 4> block_{};
};

}  // namespace ivory
