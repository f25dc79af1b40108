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
  // trilinear look-up a quarter of a voxel off its surface reads a brick's neighbour where it lies less than half a
  // voxel from their border: within three quarters of one, as far as the surface may then be, all vertices are kept.
  float reach_voxels = 0.8F;
  std::vector<Box3f> dynamic_regions;  // boxes of the scene in which objects move: finest there, too
};

// The bricks of `level` (each 4 x 4 x 4 of its vertices' cells, fewer at the far sides of a frame whose sizes are no
// multiples of 4) that a triangle of the scene comes within reach_voxels of, along each axis; in order.
std::vector<V3i> bricks_near_surfaces(const Scene& scene, const GridFrame& level, float reach_voxels);

// The vertices of a level whose own point a triangle comes within reach_voxels of, along each axis. Around the others
// nothing hides anything within so many voxels.
class NearVertices {
 public:
  NearVertices(const Scene& scene, const GridFrame& level, float reach_voxels);
  bool holds(const V3i& vertex) const {
    const std::size_t brick =
        (std::size_t(vertex.z >> 2) * std::size_t(bricks_.y) + std::size_t(vertex.y >> 2)) * std::size_t(bricks_.x) +
        std::size_t(vertex.x >> 2);
    return (marks_[brick] >> BrickLevel::within_brick(vertex) & 1U) != 0;
  }

 private:
  V3i bricks_;
  std::vector<std::uint64_t> marks_;  // [brick] a bit a vertex
};
// Of each level.
std::vector<NearVertices> vertices_near_surfaces(const Scene& scene, const Lattice& lattice, float reach_voxels);

// The bricks of `level` that touch a box of the scene; conservative where the frame is turned.
std::vector<V3i> bricks_in_boxes(const std::vector<Box3f>& boxes, const GridFrame& level);

// The lattice whose finest level has the spacing of `finest`, a frame whose sizes are multiples of 2^levels
// (default_frame() makes them so), and whose coarsest, complete one that times 2^(levels - 1). Throws ParameterError
// for other sizes and as make_lattice() does.
Lattice make_scene_lattice(const Scene& scene, const GridFrame& finest, const SceneLatticeParams& params = {});

}  // namespace ivory
