#include "grid/lobes/moments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

// With phi the elevation above the plane of the axes and theta the azimuth in it, a_i.w = cos(phi) cos(theta - theta_i)
// and dw = cos(phi) dphi dtheta: the product separates exactly,
//
//   I = W(E + 1) J,   W(n) = int cos^n phi dphi over the half circle,   E = sum e_i,
//   J = int prod_i cos^e_i(theta - theta_i) dtheta over the arc where all cosines are positive.
//
// For two lobes J = |a1 + a2|^(E+1) B(e1+1, e2+1) 2F1((1+d)/2, (1-d)/2; (E+3)/2; cos^2(alpha/2)), d = e1 - e2; its
// series cancels for large d, and the vector moment needs more than J, so J is integrated numerically: its logarithm is
// concave, which brackets it, and what is left on the bracket is smooth but for algebraic ends, the case that tanh-sinh
// quadrature (Takahasi & Mori 1974) was made for.

namespace ivory {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double half_pi = std::numbers::pi / 2;
// Where the integrand has fallen by e^-45 = 3e-20 nothing is left that a double would add.
constexpr double negligible = 45;

struct Node {
  double p;  // abscissa in (0, 1)
  double q;  // 1 - p, exact where p is close to 1
  double weight;
};

const std::vector<Node>& nodes() {
  static const std::vector<Node> table = [] {
    // Up to 3.4 the weights have fallen below 1e-20. A Gaussian bracketed at e^-45 is 19 deviations wide, its nodes
    // 0.74 of one apart at this step: the error is about exp(-2 pi^2/0.74^2) = 2e-16.
    std::vector<Node> list;
    constexpr double step = 1.0 / 20;
    for (int i = -68; i <= 68; ++i) {
      const double t = i * step;
      const double u = std::numbers::pi * std::sinh(t);
      const double p = 1 / (1 + std::exp(-u));
      const double q = 1 / (1 + std::exp(u));
      list.push_back({p, q, step * std::numbers::pi * std::cosh(t) * p * q});
    }
    return list;
  }();
  return table;
}

// log W(n) for n >= 0, W(n) = sqrt(pi) Gamma((n+1)/2)/Gamma(n/2+1).
double log_wallis(double n) {
  const double x = n / 2;
  if (x < 30) return 0.5 * std::log(std::numbers::pi) + std::lgamma(x + 0.5) - std::lgamma(x + 1);
  // The ratio's asymptotic series, to 1e-13 here; lgamma would lose as many digits as its size has.
  const double y = 1 / x;
  const double log_ratio = y * (-0.125 + y * y * (1.0 / 192 + y * y * (-1.0 / 640 + y * y * (17.0 / 14336))));
  return 0.5 * (std::log(std::numbers::pi) - std::log(x)) + log_ratio;
}

// J and its first moments about the peak, peak value taken out.
struct ArcMoments {
  double log_peak = -infinity;
  double peak_rad = 0;
  double mass = 0;     // int f/f_peak
  double sine = 0;     // int f/f_peak sin(theta - peak)
  double versine = 0;  // int f/f_peak (1 - cos(theta - peak))
};

ArcMoments arc_moments(const std::vector<PlanarLobe>& lobes) {
  double low = -infinity;
  double high = infinity;
  for (const PlanarLobe& lobe : lobes) {
    low = std::max(low, lobe.angle_rad - half_pi);
    high = std::min(high, lobe.angle_rad + half_pi);
  }
  ArcMoments m;
  if (!(high > low)) return m;

  // cos(theta - angle) as the sine of the distance to the nearer end of the lobe's half circle: exact at both ends of
  // the arc, where the distances to them are known.
  const auto log_value = [&](double from_low, double to_high) {
    double sum = 0;
    for (const PlanarLobe& lobe : lobes) {
      if (lobe.exponent == 0) continue;
      const double left = low - (lobe.angle_rad - half_pi) + from_low;
      const double right = lobe.angle_rad + half_pi - high + to_high;
      const double sine = std::sin(std::min(left, right));
      sum += sine > 0 ? lobe.exponent * std::log(sine) : -infinity;
    }
    return sum;
  };
  const double width = high - low;

  // The slope of the logarithm falls along the arc: the peak is where it changes sign.
  const auto slope = [&](double from_low) {
    double sum = 0;
    for (const PlanarLobe& lobe : lobes) {
      if (lobe.exponent != 0) sum -= lobe.exponent * std::tan(low + from_low - lobe.angle_rad);
    }
    return sum;
  };
  double a = 0;
  double b = width;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (a + b);
    (slope(middle) > 0 ? a : b) = middle;
  }
  const double peak = 0.5 * (a + b);
  m.log_peak = log_value(peak, width - peak);
  m.peak_rad = low + peak;

  // [first, last]: what is not negligible.
  const auto bracket = [&](double end) {
    double inside = peak;
    double outside = end;
    if (log_value(end, width - end) > m.log_peak - negligible) return end;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (inside + outside);
      (log_value(middle, width - middle) > m.log_peak - negligible ? inside : outside) = middle;
    }
    return outside;
  };
  const double first = bracket(0);
  const double last = bracket(width);
  const double end_gap = last == width ? 0.0 : width - last;
  const double span = last - first;
  for (const Node& node : nodes()) {
    const double from_low = first + span * node.p;
    const double to_high = end_gap + span * node.q;
    const double f = span * node.weight * std::exp(log_value(from_low, to_high) - m.log_peak);
    const double offset = from_low - peak;
    const double half_sine = std::sin(0.5 * offset);
    m.mass += f;
    m.sine += f * std::sin(offset);
    m.versine += f * 2 * half_sine * half_sine;
  }
  return m;
}

double exponent_sum(const std::vector<PlanarLobe>& lobes) {
  double sum = 0;
  for (const PlanarLobe& lobe : lobes) sum += lobe.exponent;
  return sum;
}

}  // namespace

double log_planar_product(const std::vector<PlanarLobe>& lobes) {
  const ArcMoments m = arc_moments(lobes);
  if (!(m.mass > 0)) return -infinity;
  return m.log_peak + std::log(m.mass) + log_wallis(exponent_sum(lobes) + 1);
}

LobeProductMoments lobe_product_moments(double e1, double e2, double alpha_rad) {
  const std::vector<PlanarLobe> lobes{{e1, 0}, {e2, alpha_rad}};
  const ArcMoments m = arc_moments(lobes);
  if (!(m.mass > 0)) return {-infinity, 0.5 * alpha_rad, 2 * (e1 + e2) + 2};
  LobeProductMoments result;
  const double n = e1 + e2 + 1;
  result.log_integral = m.log_peak + std::log(m.mass) + log_wallis(n);
  const double sine = m.sine / m.mass;
  const double versine = m.versine / m.mass;
  result.axis_angle_rad = m.peak_rad + std::atan2(sine, 1 - versine);
  // Mean cosine = in-plane resultant length R times W(n+1)/W(n), both as differences from 1.
  const double one_minus_r2 = 2 * versine - versine * versine - sine * sine;
  const double one_minus_r = one_minus_r2 / (1 + std::sqrt(1 - one_minus_r2));
  const double one_minus_w = -std::expm1(log_wallis(n + 1) - log_wallis(n));
  const double one_minus_mean = one_minus_r + one_minus_w - one_minus_r * one_minus_w;
  result.exponent = 1 / one_minus_mean - 2;
  return result;
}

}  // namespace ivory
