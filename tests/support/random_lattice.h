// Lattices of several levels for the tests: where bricks stand is up to chance.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "grid/field/lattice.h"

namespace ivory {

inline GridFrame coarsest_frame(const V3i& size, bool rotated) {
  GridFrame frame;
  frame.size = size;
  frame.origin_m = V3f(3, -2, 7);
  frame.spacing_m = V3f(0.5F, 0.7F, 0.4F);
  if (rotated) {
    const M33f about_z(std::cos(0.7F), std::sin(0.7F), 0, -std::sin(0.7F), std::cos(0.7F), 0, 0, 0, 1);
    const M33f about_x(1, 0, 0, 0, std::cos(2.1F), std::sin(2.1F), 0, -std::sin(2.1F), std::cos(2.1F));
    frame.local_to_world = about_z * about_x;
  }
  return frame;
}

// `share` of the bricks of each finer level is asked for.
inline Lattice random_lattice(const V3i& coarsest, int levels, double share, std::uint32_t seed, bool rotated = true) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<std::vector<V3i>> bricks(std::size_t(levels - 1));
  for (int level = 1; level < levels; ++level) {
    const V3i count = coarsest * (1 << level) / brick_side;
    for (int i = 0; i < count.x * count.y * count.z; ++i) {
      if (uniform(random) < share)
        bricks[std::size_t(level - 1)].push_back(V3i(i % count.x, i / count.x % count.y, i / (count.x * count.y)));
    }
  }
  return make_lattice(coarsest_frame(coarsest, rotated), bricks);
}

// Every brick of every level.
inline Lattice whole_lattice(const GridFrame& coarsest, int levels) {
  Lattice lattice(coarsest);
  for (int level = 0; level + 1 < levels; ++level) {
    const V3i count = (lattice.frame_of(level).size + V3i(3, 3, 3)) / brick_side;
    std::vector<V3i> all;
    for (int i = 0; i < count.x * count.y * count.z; ++i)
      all.push_back(V3i(i % count.x, i / count.x % count.y, i / (count.x * count.y)));
    lattice = refine(lattice, level, all);
  }
  return lattice;
}

}  // namespace ivory
