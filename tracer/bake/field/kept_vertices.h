// Which grid vertices are worth storing: those that look-ups on the scene's surfaces read, and those inside
// regions where objects move.
#pragma once

#include <vector>

#include "grid/field/irradiance_grid.h"
#include "tracer/core/scene.h"

namespace ivory {

// How far from a surface a look-up reads, in voxels along each axis: the tricubic footprint reaches 2 from
// the nudged point, a quarter off its surface by default (LookupParams) and meant to lie at most 1 off it; trilinear
// look-ups, which reach 1, may be nudged by 2.
inline constexpr int guard_band_voxels = 3;

// [vertex] true within guard_band_voxels of any surface, and in the cells that touch a world-space box of
// `dynamic_regions`.
std::vector<bool> kept_vertices(const Scene& scene, const GridFrame& frame, const std::vector<Box3f>& dynamic_regions);

}  // namespace ivory
