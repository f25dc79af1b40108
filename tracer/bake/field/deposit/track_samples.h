// The sampled positions of a segment and the cells that they fall into. Private to what walks segments.
#pragma once

#include <algorithm>
#include <array>

#include "grid/field/lattice.h"

namespace ivory {

// Equal steps through a level, one a slice of the dominant axis.
struct SampleRun {
  V3f start;  // quarters of a voxel from the box's corner: vertex i's cell is [4 i, 4 i + 4)
  V3f step;
  int count = 0;
};

inline constexpr int sample_block = 8;  // positions found at once: that part vectorises

// Which of 4 x 4 x 4 places: x runs fastest.
inline int quarter_bit(int x, int y, int z) { return ((z & 3) << 4) | ((y & 3) << 2) | (x & 3); }

// The cell, and so the vertex, of sample k, held within the level, and the sample's quarter of it.
struct SampleCell {
  int x, y, z;
  int subcell;
};
inline SampleCell sample_cell(const SampleRun& run, int k, const V3i& last) {
  const auto j = static_cast<float>(k);
  const int x = static_cast<int>(run.start.x + run.step.x * j);
  const int y = static_cast<int>(run.start.y + run.step.y * j);
  const int z = static_cast<int>(run.start.z + run.step.z * j);
  return {std::min(std::max(x >> 2, 0), last.x), std::min(std::max(y >> 2, 0), last.y),
          std::min(std::max(z >> 2, 0), last.z), quarter_bit(x, y, z)};
}

// Calls visit(vertex, subcell) for each position, in order, in a level that stores all its vertices; `subcell` is the
// bit in the vertex's mask. after_block() follows every sample_block of them at most.
template <typename Visit, typename AfterBlock>
void for_each_sample(const GridFrame& frame, const SampleRun& run, const Visit& visit, const AfterBlock& after_block) {
  const V3i last = frame.size - V3i(1, 1, 1);
  const int row = frame.size.x;
  const int plane = row * frame.size.y;
  std::array<std::int32_t, sample_block> vertex;
  std::array<std::int32_t, sample_block> bit;
  for (int first = 0; first < run.count; first += sample_block) {
    for (int k = 0; k < sample_block; ++k) {
      const SampleCell sample = sample_cell(run, first + k, last);
      vertex[std::size_t(k)] = sample.z * plane + sample.y * row + sample.x;
      bit[std::size_t(k)] = sample.subcell;
    }
    const auto used = std::size_t(std::min(sample_block, run.count - first));
    for (std::size_t k = 0; k < used; ++k) visit(std::uint32_t(vertex[k]), unsigned(bit[k]));
    after_block();
  }
}

// The same of a level of bricks, for the positions whose brick is stored. Stretches without a brick are jumped over:
// from a brick whose nearest stored one is d bricks away, no position fewer than 4 d - 3 steps ahead can be in one, as
// a step moves by no more than a voxel along any axis. A step is held back, for what rounding may add.
template <typename Visit, typename AfterBlock>
void for_each_sample(const BrickLevel& level, const SampleRun& run, const Visit& visit, const AfterBlock& after_block) {
  const V3i last = level.frame.size - V3i(1, 1, 1);
  const int row = level.bricks.x;
  const int plane = row * level.bricks.y;
  const std::uint32_t* table = level.table.data();
  std::array<std::int32_t, sample_block> brick;
  std::array<std::int32_t, sample_block> within;
  std::array<std::int32_t, sample_block> bit;
  int first = 0;
  while (first < run.count) {
    for (int k = 0; k < sample_block; ++k) {
      const SampleCell sample = sample_cell(run, first + k, last);
      brick[std::size_t(k)] = (sample.z >> 2) * plane + (sample.y >> 2) * row + (sample.x >> 2);
      within[std::size_t(k)] = quarter_bit(sample.x, sample.y, sample.z);
      bit[std::size_t(k)] = sample.subcell;
    }
    const auto used = std::size_t(std::min(sample_block, run.count - first));
    std::uint32_t entry = 0;
    for (std::size_t k = 0; k < used; ++k) {
      entry = table[brick[k]];
      if (entry < no_brick) visit(entry + std::uint32_t(within[k]), unsigned(bit[k]));
    }
    after_block();
    first += int(used);
    if (entry > no_brick + 1) first += 4 * int(entry - no_brick) - 5;
  }
}

}  // namespace ivory
