// Sine and cosine in plain arithmetic: the C library chooses its own by CPU, and their last bits differ.
#pragma once

#include <cmath>

#include <ImathVec.h>

namespace ivory {

// The point of the unit circle at `turns` of a full turn from +x towards +y: (cos 2 pi turns, sin 2 pi turns), to
// 2e-16. For |turns| < 2^30. The same bits on every CPU, and no slower than the C library's.
//
// With q the nearest quarter turn and x in [-pi / 4, pi / 4] what is left of it, sine and cosine of x are Taylor sums:
// the first terms left out are x^17 / 17! < 5e-17 and x^18 / 18! < 3e-18.
inline Imath::V2d on_unit_circle(double turns) {
  const double quarters = 4 * turns;
  const double q = std::floor(quarters + 0.5);
  const double x = (quarters - q) * 1.57079632679489661923;
  const double x2 = x * x;
  // From the last term on, each the next one's factor.
  const double sine =
      x +
      x * x2 *
          (-1.0 / 6 +
           x2 * (1.0 / 120 + x2 * (-1.0 / 5040 +
                                   x2 * (1.0 / 362880 + x2 * (-1.0 / 39916800 +
                                                              x2 * (1.0 / 6227020800 - x2 * (1.0 / 1307674368000)))))));
  const double cosine =
      1 + x2 * (-0.5 +
                x2 * (1.0 / 24 +
                      x2 * (-1.0 / 720 +
                            x2 * (1.0 / 40320 + x2 * (-1.0 / 3628800 +
                                                      x2 * (1.0 / 479001600 + x2 * (-1.0 / 87178291200 +
                                                                                    x2 * (1.0 / 20922789888000))))))));
  switch (static_cast<int>(q) & 3) {
    case 0:
      return {cosine, sine};
    case 1:
      return {-sine, cosine};
    case 2:
      return {-cosine, -sine};
    default:
      return {sine, -cosine};
  }
}

}  // namespace ivory
