#include "grid/field/lattice.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "grid/base/error.h"

namespace ivory {

GridFrame finer_frame(const GridFrame& frame) {
  GridFrame finer = frame;
  finer.size = frame.size * 2;
  finer.spacing_m = frame.spacing_m * 0.5F;
  finer.origin_m = frame.origin_m - frame.direction_to_world(finer.spacing_m * 0.5F);
  return finer;
}

GridFrame coarser_frame(const GridFrame& frame, int halvings) {
  const int factor = 1 << halvings;
  GridFrame coarser = frame;
  coarser.size = frame.size / factor;
  coarser.spacing_m = frame.spacing_m * float(factor);
  coarser.origin_m = frame.origin_m + frame.direction_to_world(frame.spacing_m * (float(factor - 1) * 0.5F));
  return coarser;
}

double table_bytes(const GridFrame& coarsest, int levels) {
  double bytes = 0;
  for (int level = 1; level < levels; ++level)
    bytes += double(coarsest.vertex_count()) * std::exp2(3 * level) / brick_vertices * sizeof(std::uint32_t);
  return bytes;
}

namespace {

constexpr std::uint32_t farthest = 255;

// Calls visit(neighbour's coordinates) for the bricks of 3 x 3 x 3 around one, itself included, that lie in the level.
template <typename Visit>
void for_each_around(const V3i& brick, const V3i& bricks, const Visit& visit) {
  V3i at;
  for (at.z = std::max(brick.z - 1, 0); at.z <= std::min(brick.z + 1, bricks.z - 1); ++at.z) {
    for (at.y = std::max(brick.y - 1, 0); at.y <= std::min(brick.y + 1, bricks.y - 1); ++at.y) {
      for (at.x = std::max(brick.x - 1, 0); at.x <= std::min(brick.x + 1, bricks.x - 1); ++at.x) visit(at);
    }
  }
}

// Distances to the nearest zero along the longest axis, from a table of zeros and `farthest`: two sweeps, each of which
// asks the half of a brick's neighbours that it has passed (Rosenfeld & Pfaltz, "Distance functions on digital
// pictures", 1968: exact for this distance).
void spread_distances(BrickLevel& level) {
  std::array<V3i, 13> passed;
  std::size_t count = 0;
  for (int n = 0; n < 13; ++n) passed[count++] = V3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
  const V3i last = level.bricks - V3i(1, 1, 1);
  for (const int sign : {1, -1}) {
    V3i step;
    for (step.z = 0; step.z <= last.z; ++step.z) {
      for (step.y = 0; step.y <= last.y; ++step.y) {
        for (step.x = 0; step.x <= last.x; ++step.x) {
          const V3i at = sign > 0 ? step : last - step;
          std::uint32_t& distance = level.table[level.brick_index(at)];
          if (distance == 0) continue;
          for (const V3i& offset : passed) {
            const V3i from = at + offset * sign;
            if (from.x < 0 || from.y < 0 || from.z < 0 || from.x > last.x || from.y > last.y || from.z > last.z)
              continue;
            distance = std::min(distance, level.table[level.brick_index(from)] + 1);
          }
        }
      }
    }
  }
}

// From marks (0: stored) to the finished level.
void number_bricks(BrickLevel& level, std::size_t first_vertex) {
  V3i at;
  for (at.z = 0; at.z < level.bricks.z; ++at.z) {
    for (at.y = 0; at.y < level.bricks.y; ++at.y) {
      for (at.x = 0; at.x < level.bricks.x; ++at.x) {
        if (level.table[level.brick_index(at)] == 0) level.stored.push_back(at);
      }
    }
  }
  if (double(first_vertex) + double(level.stored.size()) * brick_vertices >= double(no_brick))
    throw ParameterError("lattice", "it has more than the 2^32 vertices that can be numbered");
  level.first_vertex = std::uint32_t(first_vertex);
  spread_distances(level);
  for (std::uint32_t& entry : level.table) entry += no_brick;
  for (std::size_t i = 0; i < level.stored.size(); ++i)
    level.table[level.brick_index(level.stored[i])] = std::uint32_t(first_vertex + i * brick_vertices);
}

}  // namespace

Lattice make_lattice(const GridFrame& coarsest, const std::vector<std::vector<V3i>>& bricks) {
  Lattice lattice(coarsest);
  std::size_t levels = bricks.size();
  while (levels > 0 && bricks[levels - 1].empty()) --levels;
  if (levels == 0) return lattice;
  if (levels >= std::size_t(max_levels)) throw ParameterError("lattice", "it has too many levels");
  for (int axis = 0; axis < 3; ++axis) {
    if (coarsest.size[axis] < 2 || coarsest.size[axis] % 2 != 0)
      throw ParameterError("lattice", "its coarsest level has an odd number of vertices along an axis");
    if (double(coarsest.size[axis]) * std::exp2(levels) > 1 << 20)
      throw ParameterError("lattice", "its finest level has more than 2^20 vertices along an axis");
  }
  for (std::size_t i = 0; i < levels; ++i) {
    BrickLevel& level = lattice.finer.emplace_back();
    level.frame = finer_frame(i == 0 ? coarsest : lattice.finer[i - 1].frame);
    level.bricks = level.frame.size / brick_side;
    level.table.assign(level.brick_index({0, 0, level.bricks.z}), farthest);
  }
  for (std::size_t i = levels; i-- > 0;) {
    BrickLevel& level = lattice.finer[i];
    for (const V3i& brick : bricks[i]) {
      for (int axis = 0; axis < 3; ++axis) {
        if (brick[axis] < 0 || brick[axis] >= level.bricks[axis])
          throw ParameterError("lattice", "a brick lies outside its level");
      }
      level.table[level.brick_index(brick)] = 0;
    }
    if (i == 0) break;
    BrickLevel& coarser = lattice.finer[i - 1];
    V3i at;
    for (at.z = 0; at.z < level.bricks.z; ++at.z) {
      for (at.y = 0; at.y < level.bricks.y; ++at.y) {
        for (at.x = 0; at.x < level.bricks.x; ++at.x) {
          if (level.table[level.brick_index(at)] != 0) continue;
          for_each_around(at, level.bricks, [&](const V3i& near) { coarser.table[coarser.brick_index(near / 2)] = 0; });
        }
      }
    }
  }
  std::size_t first_vertex = coarsest.vertex_count();
  for (BrickLevel& level : lattice.finer) {
    number_bricks(level, first_vertex);
    first_vertex += level.stored.size() * brick_vertices;
  }
  return lattice;
}

Lattice refine(const Lattice& lattice, int level, const std::vector<V3i>& bricks) {
  std::vector<std::vector<V3i>> all;
  for (const BrickLevel& finer : lattice.finer) all.push_back(finer.stored);
  if (std::size_t(level) >= all.size()) all.resize(std::size_t(level) + 1);
  const V3i size = lattice.frame.size * (1 << level);
  const V3i blocks = (size + V3i(3, 3, 3)) / brick_side;
  const V3i end = size * 2 / brick_side;  // a block at the coarsest level's far sides has children outside of it
  for (const V3i& brick : bricks) {
    if (brick.x < 0 || brick.y < 0 || brick.z < 0 || brick.x >= blocks.x || brick.y >= blocks.y || brick.z >= blocks.z)
      throw ParameterError("lattice", "a brick lies outside its level");
    for (int child = 0; child < 8; ++child) {
      const V3i at = brick * 2 + V3i(child & 1, child >> 1 & 1, child >> 2);
      if (at.x < end.x && at.y < end.y && at.z < end.z) all[std::size_t(level)].push_back(at);
    }
  }
  return make_lattice(lattice.frame, all);
}

void set_frame(Lattice& lattice, const GridFrame& coarsest) {
  assert(lattice.frame.size == coarsest.size);
  lattice.frame = coarsest;
  const GridFrame* coarser = &lattice.frame;
  for (BrickLevel& level : lattice.finer) {
    level.frame = finer_frame(*coarser);
    coarser = &level.frame;
  }
}

}  // namespace ivory
