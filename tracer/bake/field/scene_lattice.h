// Which bricks a lattice needs for a scene: fine near surfaces, where light varies and look-ups read, coarse in the
// open.
#pragma once

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

// The bricks of `level` (each 4 x 4 x 4 of its vertices' cells) that a triangle of the scene comes within reach_voxels
// of, in order. Takes a byte for each brick of the frame.
std::vector<V3i> bricks_near_surfaces(const Scene& scene, const GridFrame& level, float reach_voxels);

// The bricks of `level` that touch a box of the scene; conservative where the frame is turned.
std::vector<V3i> bricks_in_boxes(const std::vector<Box3f>& boxes, const GridFrame& level);

// The lattice whose finest level has the spacing of `finest`, a frame whose sizes are multiples of 2^levels
// (default_frame() makes them so), and whose coarsest, complete one that times 2^(levels - 1). Throws ParameterError
// for other sizes and as make_lattice() does.
Lattice make_scene_lattice(const Scene& scene, const GridFrame& finest, const SceneLatticeParams& params = {});

}  // namespace ivory
