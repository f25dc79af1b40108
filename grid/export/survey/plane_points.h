// Points on surfaces that a grid knows of without its scene: those of its guard's planes.
#pragma once

#include <cstdint>
#include <optional>

#include "grid/field/irradiance_grid.h"

namespace ivory {

struct SurfacePoint {
  V3f p;  // relative to the grid's anchor
  V3f n;  // unit, towards the lit side
};

// Try number `index` at a point of a plane within a voxel of a lit vertex, the vertices even; nothing where this one
// hits none. The same for the same seed and index. The grid has a guard.
std::optional<SurfacePoint> plane_point(const IrradianceGrid& grid, std::uint64_t seed, std::uint64_t index);

}  // namespace ivory
