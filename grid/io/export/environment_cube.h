// Distant light as a cube map for Bevy's EnvironmentMapLight.
#pragma once

#include <string>

#include "grid/export/distant.h"

namespace ivory {

struct EnvironmentCube {
  int size = 0;         // texels along an edge of a face
  float intensity = 1;  // what EnvironmentMapLight::intensity is to be
};

// KTX2, half floats, six faces of E / pi / intensity, zstd. The intensity is a power of two: 1 where halves hold the
// light as it is. Throws Error as write_file() does.
EnvironmentCube write_bevy_cube(const std::string& path, const DistantLight& light, bool force);

}  // namespace ivory
