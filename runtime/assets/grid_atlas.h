// Where a grid's vertices and volumes lie in its 3D textures.
#pragma once

#include <cstdint>
#include <vector>

#include "grid/field/lattice.h"

namespace ivory {

// How `count` volumes of that many vertices are put side by side in a texture of at most `limit` texels a side: number
// of tiles along x, y and z, whose product is `count`, so that no memory is wasted; (0, 0, 0) where nothing fits.
V3i arrange_volumes(const V3i& vertices, int count, int limit);
// First texel of volume f.
V3i volume_place(const V3i& vertices, const V3i& tiles, int f);

// Where vertices lie in textures. A grid of one level: at their coordinates. Of several: in bricks of 4 x 4 x 4, the
// coarsest level's blocks first, then the finer levels' by number; shaders/field/levels.glsl says how they are found.
struct GridAtlas {
  V3i size{0, 0, 0};  // texels
  V3i bits{0, 0, 0};  // log2 of the bricks along x, along y, and of a slice
  std::uint32_t coarsest_bricks = 0;
  std::vector<int> tables;  // [level] first entry of its table
  int table_slice = 0;      // of the guard's texture, where the tables begin,
  int table_slices = 0;     // and how many they fill

  V3i texel_of(const Lattice& lattice, std::uint32_t vertex) const;
};

// The atlas of a lattice whose volumes, `count` of them, fit into a texture of at most `limit` texels a side, if any
// does.
GridAtlas arrange_vertices(const Lattice& lattice, int count, int limit);

// All levels' tables, one after another: the number of each brick's place in the atlas, or 2^32 - 1 for none.
std::vector<std::uint32_t> brick_tables(const Lattice& lattice, const GridAtlas& atlas);

}  // namespace ivory
