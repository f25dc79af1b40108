#include "grid/env/difmap.h"

#include <algorithm>
#include <cmath>

namespace ivory {

Sh9Error sh9_error(const Sh9& sh, const CubeMap& truth, const V3d& total_radiance) {
  Sh9Error out;
  double weights = 0;
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < truth.size; ++row) {
      for (int column = 0; column < truth.size; ++column) {
        const V3f n = cube_texel_direction(truth.size, face, row, column);
        const Rgb exact = truth.texels[cube_index(truth.size, face, row, column)];
        const V3d e = irradiance_polynomial(sh, V3d(n));
        const double solid_angle = cube_texel_solid_angle(truth.size, row, column);
        for (unsigned c = 0; c < 3; ++c) {
          if (!(total_radiance[int(c)] > 0)) continue;
          const double error = std::abs(std::max(0.0, e[int(c)]) - double(exact[c])) / total_radiance[int(c)];
          out.average += error * solid_angle;
          out.maximum = std::max(out.maximum, error);
          weights += solid_angle;
        }
      }
    }
  }
  if (weights > 0) out.average /= weights;
  return out;
}

}  // namespace ivory
