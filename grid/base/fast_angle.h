// The angle of a vector in the plane, from arithmetic alone: what shaders and C++ compute alike. GLSL's own atan may be
// off by 4096 units in the last place, and the C library's takes most of the time of a sum of angles.
#pragma once

#include <cmath>

#include "grid/base/types.h"

namespace ivory {

// atan2(y, x) to 6e-7 rad. (0, 0) gives 0.
//
// atan(t)/t as a polynomial in t^2 over [0, 1], relative error 2e-7: the interpolant of degree 7 at Chebyshev's points
// (numpy.polynomial.Chebyshev.interpolate over the domain [0, 1]), in powers of t^2.
inline float fast_angle(float y, float x) {
  const float ay = std::abs(y);
  const float ax = std::abs(x);
  const float longer = ay > ax ? ay : ax;
  const float shorter = ay > ax ? ax : ay;
  const float t = longer > 0 ? shorter / longer : 0.0F;
  const float t2 = t * t;
  float angle = -0.00455979211F;
  angle = angle * t2 + 0.0237805191F;
  angle = angle * t2 - 0.0588297546F;
  angle = angle * t2 + 0.0986886546F;
  angle = angle * t2 - 0.140032902F;
  angle = angle * t2 + 0.199669614F;
  angle = angle * t2 - 0.333318114F;
  angle = (angle * t2 + 0.999999881F) * t;
  if (ay > ax) angle = 0.5F * pi - angle;
  if (x < 0) angle = pi - angle;
  return y < 0 ? -angle : angle;
}

}  // namespace ivory
