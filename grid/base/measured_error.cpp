#include "grid/base/measured_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

// Squared errors are skewed: a few points hold most of their sum, and mean +- 1.96 standard errors misses on the high
// side far more often than it says. Hall ("On the removal of skewness by transformation", J. R. Statist. Soc. B 54,
// 1992) turns the studentised mean T = sqrt(n) (m - mu) / s of values of skewness g into
//
//   T + g (a T^2 + b) / sqrt(n) + (a g)^2 T^3 / (3 n),   a = 1/3, b = 1/6,
//
// which is normal but for terms of 1/n, and can be inverted:
//
//   T = sqrt(n) / (a g) [ (1 + 3 a g (z / sqrt(n) - b g / n))^(1/3) - 1 ].

namespace ivory {

namespace {

constexpr double normal_quantile = 1.959964;  // of 97.5 %

struct Interval {
  double mean = 0;
  double low = 0;
  double high = 0;
};

Interval mean_interval(const std::vector<double>& values) {
  const auto n = double(values.size());
  Interval interval;
  for (const double v : values) interval.mean += v / n;
  interval.low = interval.high = interval.mean;
  if (values.size() < 2) return interval;
  double second = 0;
  double third = 0;
  for (const double v : values) {
    const double d = v - interval.mean;
    second += d * d;
    third += d * d * d;
  }
  const double deviation = std::sqrt(second / (n - 1));
  if (!(deviation > 0)) return interval;
  const double skewness = third / n / std::pow(second / n, 1.5);
  const auto studentised = [&](double z) {
    constexpr double a = 1.0 / 3;
    constexpr double b = 1.0 / 6;
    if (std::abs(skewness) < 1e-6) return z;
    return std::sqrt(n) / (a * skewness) *
           (std::cbrt(1 + 3 * a * skewness * (z / std::sqrt(n) - b * skewness / n)) - 1);
  };
  const double unit = deviation / std::sqrt(n);
  interval.low = interval.mean - unit * studentised(normal_quantile);
  interval.high = interval.mean - unit * studentised(-normal_quantile);
  return interval;
}

}  // namespace

MeasuredError root_mean_square(std::span<const PointError> points) {
  const auto n = double(points.size());
  double square = 0;
  double truth = 0;
  for (const PointError& point : points) {
    square += point.squared / n;
    truth += point.truth / n;
  }
  if (points.empty() || (!(truth > 0) && !(square > 0))) return {};
  if (!(truth > 0)) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    return {infinite, infinite, infinite};
  }
  // The ratio R = Q / M^2 of two means, to first order in both: what a point adds to it.
  std::vector<double> shares;
  for (const PointError& point : points) {
    shares.push_back(square / (truth * truth) + (point.squared - square) / (truth * truth) -
                     2 * square / (truth * truth * truth) * (point.truth - truth));
  }
  const Interval ratio = mean_interval(shares);
  const auto root = [](double x) { return std::sqrt(std::max(x, 0.0)); };
  const double error = root(square) / truth;
  return {error, std::min(root(ratio.low), error), std::max(root(ratio.high), error)};
}

MeasuredError mean_error(std::span<const double> errors) {
  const Interval mean = mean_interval({errors.begin(), errors.end()});
  return {mean.mean, std::max(0.0, std::min(mean.low, mean.mean)), std::max(mean.high, mean.mean)};
}

}  // namespace ivory
