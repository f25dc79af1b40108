// Irradiance environment maps in nine spherical harmonics: Ramamoorthi & Hanrahan, "An Efficient Representation for
// Irradiance Environment Maps", 2001 (equation numbers below are theirs).
//
// Real, all-positive basis (eq. 3), raw radiance projection (eq. 10), in the order L00, L1-1 (y), L10 (z), L11 (x),
// L2-2 (xy), L2-1 (yz), L20 (3 z^2 - 1), L21 (xz), L22 (x^2 - y^2).
#pragma once

#include <array>

#include "grid/base/types.h"
#include "grid/env/moments.h"

namespace ivory {

struct Sh9 {
  std::array<V3d, 9> coefficients{V3d(0, 0, 0), V3d(0, 0, 0), V3d(0, 0, 0), V3d(0, 0, 0), V3d(0, 0, 0),
                                  V3d(0, 0, 0), V3d(0, 0, 0), V3d(0, 0, 0), V3d(0, 0, 0)};  // RGB, nits sr^(1/2)
};

// The factor K of each basis function, so that Y_i(w) = K_i times 1, y, z, x, xy, yz, 3z^2 - 1, xz, x^2 - y^2 (eq. 3),
// and those polynomials of a unit vector.
extern const std::array<double, 9> sh9_factor;
std::array<double, 9> sh9_polynomials(const V3d& w);
// The clamped cosine's coefficient of each function's band: E_i = A_i L_i (eq. 9).
extern const std::array<double, 9> sh9_cosine;

// Eq. 10 by the moments of the map: the harmonics are quadratic polynomials of w.
Sh9 sh9_from_moments(const RadianceMoments& moments);

// The bands up to `order` (0, 1 or 2), the others zero.
Sh9 truncated(const Sh9& sh, int order);

// E(n) in lux as the quadratic polynomial of eq. 13, which may be negative. n is a unit vector.
V3d irradiance_polynomial(const Sh9& sh, const V3d& n);

// The symmetric matrices of eq. 12, one a colour channel, row by row: E(n) = (n 1) M (n 1)^T (eq. 11).
using Sh9Matrices = std::array<std::array<double, 16>, 3>;
Sh9Matrices sh9_matrices(const Sh9& sh);

// E(n) in lux by eq. 11 in floats, never negative: what shaders evaluate.
using Sh9MatricesF = std::array<std::array<float, 16>, 3>;
Sh9MatricesF to_float(const Sh9Matrices& matrices);
Rgb irradiance(const Sh9MatricesF& matrices, const V3f& n);

// The least value of the polynomial over all normals, per channel: exact, to rounding.
V3d minimum_irradiance(const Sh9& sh);

// Factors of bands 1 and 2, against the lobes that a few bands leave around concentrated light, where the polynomial
// falls below zero. Band 0, the total light, stays.
struct Sh9Window {
  double band1 = 1;
  double band2 = 1;
};
Sh9 windowed(const Sh9& sh, const Sh9Window& window);

// The Hann window of `width` bands, 2 or more: (1 + cos(pi l / width)) / 2.
Sh9Window hann_window(double width);

// The factors that change E(n) least, in mean square over all normals (channels by their own mean E), of those after
// which no channel is negative for any normal. Both are 1 where nothing is negative to begin with.
Sh9Window least_window(const Sh9& sh);

}  // namespace ivory
