#include "tracer/bake/field/contract/mean_square.h"

#include <cmath>
#include <limits>

// With weights w, squares q and values m the error is
//
//   T = (sum w q / sum w) / (sum w m / sum w)^2, error = sqrt(T),
//
// and to first order ln T varies with each sample by z_i = w q / (sum w q) - 2 w m / (sum w m) + w / (sum w): the
// delta method. Squares of errors have a long tail (a tenth of the points holds 70 % of their sum), so the sum is too
// small more often than too large, and with it its own spread: among 300 samples of log-normal squares of that tail
// (sigma 1.3 to 1.8) a symmetrical interval in ln T misses the truth above it in 7 to 13 of 100 cases. Reaching 2.6
// standard errors up and 1.96 down it held the truth in 95, 98 (300, 1000 samples, sigma 1.3), 93 and 95 (sigma 1.8).

namespace ivory {

ErrorInterval root_mean_square(const std::vector<ErrorSample>& samples) {
  constexpr double up = 2.6;
  constexpr double down = 1.96;
  double weights = 0;
  double squares = 0;
  double values = 0;
  for (const ErrorSample& s : samples) {
    weights += s.weight;
    squares += s.weight * s.square;
    values += s.weight * s.value;
  }
  // Of T itself, not of its logarithm, which has no expansion where T is not well above 0.
  const double scale = weights / (values * values);
  const double t = squares * scale;
  double variance = 0;
  for (const ErrorSample& s : samples) {
    const double z = s.weight * s.square * scale + t * (s.weight / weights - 2 * s.weight * s.value / values);
    variance += z * z;
  }
  const double n = double(samples.size());
  const double se = std::sqrt(variance * n / (n - 1));

  ErrorInterval out;
  out.error = std::sqrt(std::max(0.0, t));
  constexpr double well_above = 4;
  if (t > well_above * se) {
    const double log_se = se / t;
    out.low = out.error * std::exp(-down / 2 * log_se);
    out.high = out.error * std::exp(up / 2 * log_se);
  } else {
    out.low = std::sqrt(std::max(0.0, t - down * se));
    out.high = std::sqrt(std::max(0.0, t) + up * se);
  }
  out.log_standard_error = t > 0 ? se / (2 * t) : std::numeric_limits<double>::infinity();
  return out;
}

}  // namespace ivory
