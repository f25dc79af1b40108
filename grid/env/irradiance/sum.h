// Irradiance of an environment map for given normals by a sum over all of its texels: slow, and as exact as the map.
#pragma once

#include <span>
#include <vector>

#include "grid/env/environment_image.h"

namespace ivory {

struct IrradianceSums {
  std::vector<V3d> e;        // lux, one a normal
  V3d error_bound{0, 0, 0};  // for all of them: |e - exact| is at most this, for maps constant over each texel
};

// Normals are unit vectors. Texels above the horizon count exactly; those that it cuts are divided by 4 by 4, and their
// parts again, to 4096 rows or more over the sphere where three times suffice for that. On all of TBB's threads; the
// bits do not depend on their number.
IrradianceSums sum_irradiance(const EnvironmentImage& image, std::span<const V3f> normals);

}  // namespace ivory
