#include "runtime/assets/grid_atlas.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ivory {

namespace {

std::int64_t longest_side(const V3i& vertices, const V3i& tiles) {
  return std::max(
      {std::int64_t(vertices.x) * tiles.x, std::int64_t(vertices.y) * tiles.y, std::int64_t(vertices.z) * tiles.z});
}

// Of 4 x 4 x 4 vertices of the coarsest level, those at its far sides smaller.
V3i blocks_of(const GridFrame& frame) { return (frame.size + V3i(3, 3, 3)) / brick_side; }

}  // namespace

// Along z where that fits, as then each volume is contiguous; else the arrangement with the shortest longest side.
V3i arrange_volumes(const V3i& vertices, int count, int limit) {
  V3i best(1, 1, count);
  if (longest_side(vertices, best) <= limit) return best;
  for (int x = 1; x <= count; ++x) {
    for (int y = 1; x * y <= count; ++y) {
      const V3i tiles(x, y, count / (x * y));
      if (count % (x * y) == 0 && longest_side(vertices, tiles) < longest_side(vertices, best)) best = tiles;
    }
  }
  return longest_side(vertices, best) <= limit ? best : V3i(0, 0, 0);
}

V3i volume_place(const V3i& vertices, const V3i& tiles, int f) {
  return V3i(f % tiles.x, f / tiles.x % tiles.y, f / (tiles.x * tiles.y)) * vertices;
}

V3i GridAtlas::texel_of(const Lattice& lattice, std::uint32_t vertex) const {
  const VertexPlace place = lattice.place_of(vertex);
  if (lattice.levels() == 1) return place.at;
  std::uint32_t slot = 0;
  if (place.level == 0) {
    const V3i blocks = blocks_of(lattice.frame);
    const V3i block = place.at / brick_side;
    slot = std::uint32_t((block.z * blocks.y + block.y) * blocks.x + block.x);
  } else {
    slot = coarsest_bricks + (vertex - lattice.finer[0].first_vertex) / brick_vertices;
  }
  const V3i brick(int(slot) & ((1 << bits.x) - 1), int(slot) >> bits.x & ((1 << bits.y) - 1), int(slot) >> bits.z);
  return brick * brick_side + V3i(place.at.x & 3, place.at.y & 3, place.at.z & 3);
}

// Bricks fill a box whose sides along x and y are powers of two, which shaders find their way in by shifts, as near to
// a cube as leaves few of them empty, or flatter where a texture cannot be so high.
GridAtlas arrange_vertices(const Lattice& lattice, int count, int limit) {
  GridAtlas atlas;
  if (lattice.levels() == 1) {
    atlas.size = lattice.frame.size;
    return atlas;
  }
  const V3i blocks = blocks_of(lattice.frame);
  atlas.coarsest_bricks = std::uint32_t(blocks.x * blocks.y * blocks.z);
  std::size_t bricks = atlas.coarsest_bricks;
  std::size_t entries = atlas.coarsest_bricks;
  atlas.tables = {0};
  for (const BrickLevel& level : lattice.finer) {
    atlas.tables.push_back(int(entries));
    bricks += level.stored.size();
    entries += level.table.size();
  }
  const int cube_bits = int(std::log2(std::cbrt(double(bricks))));
  for (int sum = 2 * cube_bits; sum < 20; ++sum) {
    atlas.bits = {(sum + 1) / 2, sum / 2, sum};
    const auto a_slice = std::size_t(1) << unsigned(sum);
    atlas.size = {brick_side << atlas.bits.x, brick_side << atlas.bits.y,
                  brick_side * int((bricks + a_slice - 1) / a_slice)};
    const std::size_t words_a_slice = a_slice * brick_side * brick_side * 4;
    atlas.table_slices = int((entries + words_a_slice - 1) / words_a_slice);
    if (arrange_volumes(atlas.size, count, limit).x != 0 && atlas.size.z + atlas.table_slices <= limit) break;
  }
  return atlas;
}

std::vector<std::uint32_t> brick_tables(const Lattice& lattice, const GridAtlas& atlas) {
  std::vector<std::uint32_t> tables(atlas.coarsest_bricks);
  std::iota(tables.begin(), tables.end(), 0U);
  for (const BrickLevel& level : lattice.finer) {
    for (const std::uint32_t entry : level.table) {
      tables.push_back(entry >= no_brick
                           ? 0xFFFFFFFFU
                           : atlas.coarsest_bricks + (entry - lattice.finer[0].first_vertex) / brick_vertices);
    }
  }
  return tables;
}

}  // namespace ivory
