#include "tools/stability/gaussians.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ivory {

namespace {}

// 4 pi sinh(m)/m exp(-l1 - l2) with m = |l1 a1 + l2 a2| (Tsai & Shih 2006, eq. 3), scaled so that nothing overflows.
double gaussian_product(double l1, double l2, double alpha) {
  const double m = std::sqrt(std::max(0.0, l1 * l1 + l2 * l2 + 2 * l1 * l2 * std::cos(alpha)));
  const double ratio = m > 1e-6 ? (1 - std::exp(-2 * m)) / (2 * m) : 1;
  return 4 * std::numbers::pi * ratio * std::exp(m - l1 - l2);
}

// The mean cosine coth(l) - 1/l of a Gaussian is to be the cap's, (1 + cos(half angle))/2.
SphericalGaussian cap_gaussian(double half_angle) {
  const double mean_cosine = (1 + std::cos(half_angle)) / 2;
  double low = 1e-3;
  double high = 1e8;
  for (int i = 0; i < 200; ++i) {
    const double middle = std::sqrt(low * high);
    (1 / std::tanh(middle) - 1 / middle < mean_cosine ? low : high) = middle;
  }
  return {low, (1 - std::cos(half_angle)) * low / (1 - std::exp(-2 * low))};
}

double irradiance_by_cosine_gaussian(const SphericalGaussian& light, double cosine) {
  return 1.17 * light.amplitude * gaussian_product(2.133, light.sharpness, std::acos(std::clamp(cosine, -1.0, 1.0)));
}

// The clamped cosine seen through the Gaussian: softened to a parabola where the axis is near the horizon, scaled and
// lifted to be right for an axis along the normal and against it.
double irradiance_by_fit(const SphericalGaussian& light, double cosine) {
  const double l = light.sharpness;
  const double e1 = std::exp(-l);
  const double e2 = std::exp(-2 * l);
  const double scale = 1 + 2 * e2 - 1 / l;
  const double bias = (e1 - e2) / l - e2;
  const double width = std::sqrt(1 - scale);
  constexpr double slope = 0.36;
  const double along = slope * cosine;
  const double reach = width / (4 * slope);
  const double softened = std::abs(along) <= reach ? (along + reach) * (along + reach) / width : std::max(0.0, cosine);
  return (scale * softened + bias) * light.amplitude * 2 * std::numbers::pi / l;
}

}  // namespace ivory
