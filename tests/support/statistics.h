// Statistics for tests of Monte Carlo estimators: with fixed seeds a test either always passes or
// always fails, and the stated false-alarm rates are those of choosing a seed at random.
#pragma once

#include <cmath>
#include <vector>

namespace ivory {

// Mean and standard error of independent samples (Welford).
class Accumulator {
 public:
  void add(double x) {
    ++count_;
    const double delta = x - mean_;
    mean_ += delta / count_;
    squares_ += delta * (x - mean_);
  }
  double mean() const { return mean_; }
  double standard_error() const { return std::sqrt(squares_ / (count_ * (count_ - 1))); }
  double variance() const { return squares_ / (count_ - 1); }

 private:
  double count_ = 0;
  double mean_ = 0;
  double squares_ = 0;
};

// |z| beyond this is a false alarm once in 15,800 tests of a correct estimator (two-sided normal).
inline constexpr double z_limit = 4.0;

inline double z_score(const Accumulator& samples, double truth) {
  // 1e-6 relative is float rounding, which no number of samples averages out.
  return (samples.mean() - truth) / (samples.standard_error() + 1e-6 * std::abs(truth) + 1e-30);
}

inline double z_score(const Accumulator& a, const Accumulator& b) {
  const double error = std::hypot(a.standard_error(), b.standard_error());
  return (a.mean() - b.mean()) / (error + 1e-6 * std::abs(b.mean()) + 1e-30);
}

// Chi-square of counts against expected counts, as a standard normal score (Wilson & Hilferty 1931,
// good to 0.05 for more than ten degrees of freedom). Cells expecting fewer than 10 are pooled.
inline double chi_square_score(const std::vector<double>& counts, const std::vector<double>& expected) {
  double chi2 = 0;
  double pooled_count = 0;
  double pooled_expected = 0;
  int cells = 0;
  const auto add = [&](double count, double mean) {
    chi2 += (count - mean) * (count - mean) / mean;
    ++cells;
  };
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (expected[i] >= 10) {
      add(counts[i], expected[i]);
    } else {
      pooled_count += counts[i];
      pooled_expected += expected[i];
    }
  }
  if (pooled_expected >= 10) add(pooled_count, pooled_expected);
  const double k = cells - 1;
  return (std::cbrt(chi2 / k) - (1 - 2 / (9 * k))) / std::sqrt(2 / (9 * k));
}

}  // namespace ivory
