// Lat-long environment maps.
#pragma once

#include <optional>
#include <string>

#include "grid/env/cube_map.h"
#include "grid/env/layout.h"
#include "tracer/core/scene.h"

namespace ivory {

// Reads an environment map in any layout (tracer/env/image.h), resampled to lat-long where it has
// another. Throws Error as load_environment_image() does.
EnvironmentMap load_environment(const std::string& path, std::optional<EnvironmentLayout> layout = {});

// Radiance in nits arriving from direction w (unit), the texel that w falls in (piecewise constant,
// so that sampling and evaluation agree exactly).
Rgb eval(const EnvironmentMap& environment, const V3f& w);

// The map averaged over the texels of a cube by exact common areas (grid/env/cube_from_latlong.h): the flux
// through any set of cube texels is kept to the rounding of floats. size >= 1.
CubeMap cube_from_environment(const EnvironmentMap& environment, int size);

}  // namespace ivory
