// A photon's way on from a Lambertian surface.
#pragma once

#include <cmath>

#include "tracer/core/sampling.h"

namespace ivory {

// (cos, sin) of 2 pi turns for turns in [0, 1), to 2e-7: as on_unit_circle(double) (grid/base/circle.h), in float and
// with fewer terms of the Taylor sums (the first left out are x^11 / 11! < 2e-9 and x^10 / 10! < 3e-8). Plain
// arithmetic, so the same bits on every CPU.
inline V2f on_unit_circle_float(float turns) {
  const float quarters = 4 * turns;
  const int quarter = static_cast<int>(quarters + 0.5F);
  const float x = (quarters - static_cast<float>(quarter)) * 1.57079632679489661923F;
  const float x2 = x * x;
  const float x4 = x2 * x2;
  const float sine = x + x * x2 * ((-1.0F / 6 + x2 * (1.0F / 120)) + x4 * (-1.0F / 5040 + x2 * (1.0F / 362880)));
  const float cosine = 1 + x2 * ((-0.5F + x2 * (1.0F / 24)) + x4 * (-1.0F / 720 + x2 * (1.0F / 40320)));
  const bool odd = (quarter & 1) != 0;
  const float along = odd ? sine : cosine;
  const float across = odd ? cosine : sine;
  return {((quarter + 1) & 2) != 0 ? -along : along, (quarter & 2) != 0 ? -across : across};
}

// Direction around unit n with density cos/pi, unit to 1e-6; u in [0, 1)^2. Its cosine with n is at least 2^-12.
inline V3f cosine_direction(const V3f& n, const V2f& u) {
  const float r = std::sqrt(u.x);
  const V2f around = on_unit_circle_float(u.y) * r;
  return make_shading_frame(n).to_world({around.x, around.y, std::sqrt(1.0F - u.x)});
}

}  // namespace ivory
