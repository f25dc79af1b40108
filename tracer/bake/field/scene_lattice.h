// Which bricks a lattice needs for a scene: fine near surfaces, where light varies and look-ups read, coarse in the
// open.
#pragma once

#include <cstdint>
#include <vector>

#include "grid/field/lattice.h"
#include "tracer/core/scene.h"

namespace ivory {

struct SceneLatticeParams {
  int levels = 3;  // 1: uniform
  // A brick is stored in the finest level where a surface comes within this many of its voxels, along each axis. A
  // trilinear look-up a quarter of a voxel off its surface reads vertices at most a voxel from there, which this keeps
  // for surfaces in any place of their cells.
  float reach_voxels = 1.5F;
  std::vector<Box3f> dynamic_regions;  // boxes of the scene in which objects move: finest there, too
};

// A byte for each brick of a level: 4 x 4 x 4 of its vertices' cells, fewer at the far sides of a frame whose sizes are
// no multiples of 4.
struct BrickMarks {
  V3i bricks{0, 0, 0};
  std::vector<std::uint8_t> marked;  // [brick], x fastest

  explicit BrickMarks(const GridFrame& level);
  std::size_t index(const V3i& brick) const {
    return (std::size_t(brick.z) * std::size_t(bricks.y) + std::size_t(brick.y)) * std::size_t(bricks.x) +
           std::size_t(brick.x);
  }
  bool holds(const V3i& vertex) const { return marked[index({vertex.x >> 2, vertex.y >> 2, vertex.z >> 2})] != 0; }
  std::vector<V3i> list() const;  // the marked bricks, in order
};

// The bricks of `level` that a triangle of the scene comes within reach_voxels of, along each axis.
BrickMarks bricks_near_surfaces(const Scene& scene, const GridFrame& level, float reach_voxels);
// The same of each level of a lattice. Around vertices that are not in these, within so many voxels along each axis,
// nothing hides anything.
std::vector<BrickMarks> bricks_near_surfaces(const Scene& scene, const Lattice& lattice, float reach_voxels);

// The bricks of `level` that touch a box of the scene; conservative where the frame is turned.
std::vector<V3i> bricks_in_boxes(const std::vector<Box3f>& boxes, const GridFrame& level);

// The lattice whose finest level has the spacing of `finest`, a frame whose sizes are multiples of 2^levels
// (default_frame() makes them so), and whose coarsest, complete one that times 2^(levels - 1). Throws ParameterError
// for other sizes and as make_lattice() does.
Lattice make_scene_lattice(const Scene& scene, const GridFrame& finest, const SceneLatticeParams& params = {});

}  // namespace ivory
