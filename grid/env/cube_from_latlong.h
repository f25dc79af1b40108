// From lat-long maps to cube maps, area by area.
#pragma once

#include <span>

#include "grid/env/cube_map.h"

namespace ivory {

// Each cube texel is the mean, over its solid angle, of the piecewise constant radiance of the lat-long map: every pair
// of texels shares its exact common area (closed form, in double), so that constant maps stay constant and the flux
// through any set of cube texels is that of the map through the same directions, to rounding. `texels` holds width *
// height values from the top row (+Y) down; column 0 begins at -Z, +X is at a quarter, +Z in the middle. Black where
// the map is black; width, height, size >= 1.
CubeMap cube_from_latlong(std::span<const Rgb> texels, int width, int height, int size);

}  // namespace ivory
