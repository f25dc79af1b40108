// Environment maps in any layout, as they lie in their files.
#pragma once

#include <variant>

#include "grid/env/angular_map.h"
#include "grid/env/cube_map.h"
#include "grid/env/latlong_map.h"
#include "grid/env/layout.h"

namespace ivory {

// Radiance in nits, piecewise constant over the texels.
struct EnvironmentImage {
  EnvironmentLayout layout = EnvironmentLayout::latlong;
  std::variant<EnvironmentMap, CubeMap, AngularMap> map;  // CubeMap for crosses and faces
};

// The same light as a lat-long map: of 4 x 2 face sizes for cubes, twice the disc's size for angular maps, so that
// nothing is coarser than before. Texels that stand out from their darkest neighbour more than fourfold are spread over
// the lat-long texels that they cover, each with its own flux; the rest is averaged at evenly spread points and scaled
// to its own flux per channel. So constant maps stay constant, a sun keeps its flux where it stands, and the integral
// over the sphere is kept to the rounding of floats. On all of TBB's threads; the bits do not depend on their number.
EnvironmentMap to_latlong(EnvironmentImage image);

}  // namespace ivory
