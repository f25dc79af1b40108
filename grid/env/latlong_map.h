// Lat-long environment maps.
#pragma once

#include <vector>

#include "grid/env/cube_map.h"

namespace ivory {

// Lat-long radiance in nits, as OpenEXR defines the layout: row 0 looks towards +Y; u = 0.5 + atan2(-x, z) / (2 pi), so
// the centre of the image looks along +Z and +X lies to its left.
struct EnvironmentMap {
  int width = 0;
  int height = 0;
  std::vector<Rgb> radiance;  // height x width
};

// Radiance in nits arriving from direction w (unit): the texel that w falls in (piecewise constant, so that sampling
// and evaluation agree exactly).
Rgb eval(const EnvironmentMap& environment, const V3f& w);

// The map averaged over the texels of a cube by exact common areas (grid/env/cube_from_latlong.h): the flux through any
// set of cube texels is kept to the rounding of floats. size >= 1.
CubeMap cube_from_environment(const EnvironmentMap& environment, int size);

}  // namespace ivory
