#include "tracer/bsdf/microfacet_albedo.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

// F = f0 + (f90 - f0) (1 - h.wo)^5 makes E linear in f0 and f90:
//
//   E = f0 G + (f90 - f0) B,   G = integral of D V |ns.wi| dwi,   B = that of (1 - h.wo)^5 D V |ns.wi|.
//
// G and B are functions of mu and roughness. tools/fits/ggx_albedo.py computes them by quadrature and finds, by linear
// programming, the lowest polynomials that lie above them: G in powers of 1 - mu (rows) and of roughness = sqrt(alpha)
// (columns from the zeroth), B in those of 1 - mu and of t = 1 / (1 + 8 alpha) (from the first). It printed the numbers
// below. The error is one-sided because it must be: whatever is too low makes a white surface reflect more than
// arrives. Where f90 < f0, which glTF cannot say, f0 G alone is the bound.

namespace ivory {

namespace {

constexpr std::array<std::array<double, 6>, 6> bound_g{{
    {1.0007, 0.0006663507, -0.1685614, 1.603242, -5.662997, 3.559599},
    {0.01591322, -0.7587407, 9.204089, -33.73769, 45.00276, -19.60733},
    {-0.09851315, 4.586061, -53.26901, 172.5005, -211.3273, 88.40293},
    {0.3153812, -14.54245, 169.4792, -544.6601, 664.0224, -276.5727},
    {-0.448434, 20.25374, -231.9767, 710.9387, -828.1586, 331.3308},
    {0.2164247, -9.575748, 106.9544, -307.1779, 336.671, -127.3164},
}};

constexpr std::array<std::array<double, 4>, 6> bound_b{{
    {0.003264776, -0.01117413, 0.004610833, 0.01695061},
    {0.007208752, 0.07411225, 0.004549425, -0.4635558},
    {0.2558115, -2.521831, 4.053076, 1.587256},
    {-0.3543069, 12.38502, -32.77022, 9.998386},
    {-1.434986, -7.336312, 46.13331, -23.47684},
    {1.880104, -1.952615, -17.28112, 12.19224},
}};

template <std::size_t n>
double polynomial(const std::array<double, n>& c, double x) {
  double sum = 0;
  for (std::size_t i = n; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

}  // namespace

AlbedoPolynomial make_albedo_polynomial(float f0, float f90, float alpha) {
  const double roughness = std::sqrt(double(alpha));
  const double t = 1 / (1 + 8 * double(alpha));
  const double rise = std::max(0.0, double(f90) - double(f0)) * t;
  AlbedoPolynomial e{};
  for (std::size_t k = 0; k < e.size(); ++k)
    e[k] = float(double(f0) * polynomial(bound_g[k], roughness) + rise * polynomial(bound_b[k], t));
  return e;
}

// 2 integral of (1 - mu)^k mu dmu = 2 / ((k + 1) (k + 2)).
float mean_left_below(const AlbedoPolynomial& e) {
  double sum = 0;
  for (std::size_t k = 0; k < e.size(); ++k) sum += double(e[k]) * 2 / (double(k + 1) * double(k + 2));
  return float(1 - sum);
}

}  // namespace ivory
