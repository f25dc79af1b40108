// Lat-long environment maps.
#pragma once

#include <string>

#include "grid/cube_map.h"
#include "tracer/scene.h"

namespace ivory {

// Reads any image OpenImageIO knows. Throws Error for unreadable files, an aspect that is not 2:1,
// and texels that are not finite; negative texels are an error too.
EnvironmentMap load_environment(const std::string& path);

// Radiance in nits arriving from direction w (unit), the texel that w falls in (piecewise constant,
// so that sampling and evaluation agree exactly).
Rgb eval(const EnvironmentMap& environment, const V3f& w);

// The map averaged over the texels of a cube by exact common areas (grid/cube_from_latlong.h): the flux
// through any set of cube texels is kept to the rounding of floats. size >= 1.
CubeMap cube_from_environment(const EnvironmentMap& environment, int size);

}  // namespace ivory
