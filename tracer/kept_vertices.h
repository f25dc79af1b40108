// Which grid vertices are worth storing: those that look-ups on the scene's surfaces read, and those inside
// regions where objects move.
#pragma once

#include <vector>

#include "grid/irradiance_grid.h"
#include "tracer/scene.h"

namespace ivory {

// How far from a surface a look-up reads, in voxels along each axis: the tricubic footprint reaches 2 from
// the nudged point, which lies at most 1 off its surface.
inline constexpr int guard_band_voxels = 3;

// [vertex] true within guard_band_voxels of any surface, and in the cells that touch a world-space box of
// `dynamic_regions`.
std::vector<bool> kept_vertices(const Scene& scene, const GridFrame& frame, const std::vector<Box3f>& dynamic_regions);

}  // namespace ivory
