// Where the vertices of a grid of several spacings stand: a complete coarse level, and finer ones in bricks where light
// varies. Memory grows with the bricks, not with the box around them.
//
// Each level halves the spacing of the one before it, and its cells tile those of the coarser level: a cell is parted
// into eight. Vertices stand in the middle of their cells, so those of different levels do not coincide. A level finer
// than the coarsest has its vertices in bricks of 4 x 4 x 4; a brick's cells fill 2 x 2 x 2 cells of the coarser level.
// Around a stored brick the coarser levels are complete: the parents of the brick and of the bricks around it (3 x 3 x
// 3 of them) are stored too. So wherever a look-up finds a part of its trilinear footprint stored, the next coarser
// level has the whole one of the same point: see level_shares().
//
// A uniform grid is the coarsest level alone.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "grid/field/frame.h"

namespace ivory {

inline constexpr int brick_side = 4;
inline constexpr int brick_vertices = brick_side * brick_side * brick_side;
inline constexpr std::uint32_t no_brick = 0xFFFFFF00U;  // vertex numbers lie below
inline constexpr int max_levels = 12;

struct BrickLevel {
  // Of all vertices that the level could have; its vertex_index() is no number of a vertex. Sides are multiples of 4.
  GridFrame frame;
  V3i bricks{0, 0, 0};             // along each axis
  std::uint32_t first_vertex = 0;  // the level's vertices are numbered from here on, brick by brick
  // [brick, x fastest] number of a brick's first vertex, whose others follow, x fastest. no_brick + d for one that is
  // not stored, where d is the distance in bricks, along the axis where it is longest, to the nearest that is; at most
  // 255.
  std::vector<std::uint32_t> table;
  std::vector<V3i> stored;  // the bricks by number

  bool operator==(const BrickLevel&) const = default;

  std::size_t brick_index(const V3i& brick) const {
    return (std::size_t(brick.z) * std::size_t(bricks.y) + std::size_t(brick.y)) * std::size_t(bricks.x) +
           std::size_t(brick.x);
  }
  // Number of the vertex at those coordinates within the frame, or some number from no_brick on.
  std::uint32_t vertex_at(const V3i& at) const {
    const std::uint32_t first = table[brick_index({at.x >> 2, at.y >> 2, at.z >> 2})];
    return first >= no_brick ? first : first + within_brick(at);
  }
  static std::uint32_t within_brick(const V3i& at) {
    return std::uint32_t((at.z & 3) << 4 | (at.y & 3) << 2 | (at.x & 3));
  }
};

// Where a vertex stands: level 0 is the coarsest, level i is finer[i - 1].
struct VertexPlace {
  int level = 0;
  V3i at{0, 0, 0};  // index coordinates in that level's frame
};

struct Lattice {
  GridFrame frame;                // the coarsest level, all of whose vertices are stored, numbered as the frame does
  std::vector<BrickLevel> finer;  // [0] has half the coarsest spacing

  Lattice() = default;
  Lattice(const GridFrame& uniform) : frame(uniform) {}  // NOLINT: a frame is a lattice of one level

  bool operator==(const Lattice&) const = default;

  int levels() const { return 1 + int(finer.size()); }
  const GridFrame& frame_of(int level) const { return level == 0 ? frame : finer[std::size_t(level - 1)].frame; }
  const GridFrame& finest_frame() const { return finer.empty() ? frame : finer.back().frame; }
  // Of the vertices of a level, and of all.
  std::size_t vertex_count_of(int level) const {
    return level == 0 ? frame.vertex_count() : finer[std::size_t(level - 1)].stored.size() * brick_vertices;
  }
  std::size_t vertex_count() const {
    return finer.empty() ? frame.vertex_count() : finer.back().first_vertex + vertex_count_of(levels() - 1);
  }
  std::uint32_t first_vertex_of(int level) const { return level == 0 ? 0 : finer[std::size_t(level - 1)].first_vertex; }

  int level_of(std::uint32_t vertex) const {
    int level = int(finer.size());
    while (level > 0 && vertex < finer[std::size_t(level - 1)].first_vertex) --level;
    return level;
  }
  VertexPlace place_of(std::uint32_t vertex) const {
    const int level = level_of(vertex);
    if (level == 0) return {0, frame.vertex_coordinates(vertex)};
    const BrickLevel& bricks = finer[std::size_t(level - 1)];
    const std::uint32_t number = vertex - bricks.first_vertex;
    const auto in = int(number % brick_vertices);
    return {level, bricks.stored[number / brick_vertices] * brick_side + V3i(in & 3, in >> 2 & 3, in >> 4)};
  }
  // World position in metres, less the anchor.
  V3f position_of(std::uint32_t vertex) const {
    const VertexPlace place = place_of(vertex);
    return frame_of(place.level).to_world(V3f(place.at));
  }
};

// The frame whose cells are eighths of that one's, and the one `halvings` levels coarser, whose size is that many times
// halved; exact but for the rounding of the origin.
GridFrame finer_frame(const GridFrame& frame);
GridFrame coarser_frame(const GridFrame& frame, int halvings);

// The lattice of that coarsest level whose level i + 1 holds at least the bricks[i], given by their coordinates; what
// the coarser levels need around them is added, and levels without a brick at the end are left out. Throws
// ParameterError where the coarsest level has an odd number of vertices along an axis and there are bricks, where a
// brick lies outside its level, and where there would be too many levels or vertices.
Lattice make_lattice(const GridFrame& coarsest, const std::vector<std::vector<V3i>>& bricks);

// The same lattice with the eight children of each of those bricks of `level` stored at the next finer one. The
// coarsest level's bricks are blocks of its vertices, those at its far sides smaller; bricks that are not stored may be
// given. Throws as make_lattice() does.
Lattice refine(const Lattice& lattice, int level, const std::vector<V3i>& bricks);

// Bytes of the tables that find a level's bricks, which alone grow with its box: to be asked before one is made.
double table_bytes(const GridFrame& coarsest, int levels);

// Puts the whole lattice where its coarsest level is to be; `coarsest` has the same size.
void set_frame(Lattice& lattice, const GridFrame& coarsest);

}  // namespace ivory
