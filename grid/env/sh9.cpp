#include "grid/env/sh9.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <ImathMatrixAlgo.h>

namespace ivory {

namespace {

// Eq. 3: sqrt(1/(4 pi)), sqrt(3/(4 pi)), sqrt(15/(4 pi)), sqrt(5/(16 pi)), sqrt(15/(16 pi)).
constexpr double y0 = 0.28209479177387814;
constexpr double y1 = 0.48860251190291992;
constexpr double y2 = 1.09254843059207907;
constexpr double y20 = 0.31539156525252001;
constexpr double y22 = 0.54627421529603953;

constexpr int band(std::size_t i) { return i == 0 ? 0 : (i < 4 ? 1 : 2); }

// min of n A n + 2 b n + c over the unit sphere. In A's own axes a Lagrange multiplier m gives n_i = -b_i / (a_i - m);
// the minimum is where m <= min a_i and |n| = 1. |n| grows with m, so bisection finds it; where b has no part along the
// least axis and |n| stays below one, the rest lies along that axis.
double least_on_sphere(Imath::M33d a, const V3d& b, double c) {
  V3d eigenvalues;
  Imath::M33d v;  // eigenvectors, its columns
  Imath::jacobiEigenSolver(a, eigenvalues, v);
  const std::array<double, 3> value{eigenvalues.x, eigenvalues.y, eigenvalues.z};
  std::array<double, 3> part{};
  double length = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) part[i] += v[int(k)][int(i)] * b[int(k)];
    length += part[i] * part[i];
  }
  length = std::sqrt(length);
  const double least = std::min({value[0], value[1], value[2]});
  // At m = least - |b| |n| is at most one; at `least` it is infinite, or the hard case.
  double low = least - length;
  double high = least;
  const auto norm2 = [&](double m) {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (part[i] != 0) sum += (part[i] / (value[i] - m)) * (part[i] / (value[i] - m));
    }
    return sum;
  };
  for (int i = 0; i < 200; ++i) {
    const double m = 0.5 * (low + high);
    if (m <= low || m >= high) break;
    (norm2(m) < 1 ? low : high) = m;
  }
  // Dual value: c + m - sum of b_i^2 / (a_i - m); equal to the minimum, and off by the square of m's error only.
  double result = c + low;
  for (std::size_t i = 0; i < 3; ++i) {
    if (part[i] != 0 && value[i] > low) result -= part[i] * part[i] / (value[i] - low);
  }
  return result;
}

}  // namespace

const std::array<double, 9> sh9_factor{y0, y1, y1, y1, y2, y2, y20, y2, y22};
const std::array<double, 9> sh9_cosine{std::numbers::pi,         2 * std::numbers::pi / 3, 2 * std::numbers::pi / 3,
                                       2 * std::numbers::pi / 3, std::numbers::pi / 4,     std::numbers::pi / 4,
                                       std::numbers::pi / 4,     std::numbers::pi / 4,     std::numbers::pi / 4};

std::array<double, 9> sh9_polynomials(const V3d& w) {
  return {1, w.y, w.z, w.x, w.x * w.y, w.y * w.z, 3 * w.z * w.z - 1, w.x * w.z, w.x * w.x - w.y * w.y};
}

Sh9 sh9_from_moments(const RadianceMoments& m) {
  Sh9 sh;
  sh.coefficients = {m.total * y0,
                     m.first[1] * y1,
                     m.first[2] * y1,
                     m.first[0] * y1,
                     m.second[3] * y2,
                     m.second[4] * y2,
                     (m.second[2] * 3 - m.total) * y20,
                     m.second[5] * y2,
                     (m.second[0] - m.second[1]) * y22};
  return sh;
}

Sh9 truncated(const Sh9& sh, int order) {
  Sh9 out;
  for (std::size_t i = 0; i < 9; ++i) {
    if (band(i) <= order) out.coefficients[i] = sh.coefficients[i];
  }
  return out;
}

V3d irradiance_polynomial(const Sh9& sh, const V3d& n) {
  const std::array<double, 9> polynomial = sh9_polynomials(n);
  V3d sum(0, 0, 0);
  for (std::size_t i = 0; i < 9; ++i) sum += sh.coefficients[i] * (sh9_cosine[i] * sh9_factor[i] * polynomial[i]);
  return sum;
}

// Eq. 12; its constants are c1 = pi/4 y22, c2 = pi/3 y1, c3 = 3 pi/4 y20, c4 = pi y0, c5 = pi/4 y20.
Sh9Matrices sh9_matrices(const Sh9& sh) {
  constexpr double c1 = std::numbers::pi / 4 * y22;
  constexpr double c2 = std::numbers::pi / 3 * y1;
  constexpr double c3 = 3 * std::numbers::pi / 4 * y20;
  constexpr double c4 = std::numbers::pi * y0;
  constexpr double c5 = std::numbers::pi / 4 * y20;
  Sh9Matrices out{};
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const auto l = [&](std::size_t i) { return sh.coefficients[i][unsigned(channel)]; };
    const double xx = c1 * l(8);
    const double xy = c1 * l(4);
    const double xz = c1 * l(7);
    const double yz = c1 * l(5);
    const double zz = c3 * l(6);
    const double x = c2 * l(3);
    const double y = c2 * l(1);
    const double z = c2 * l(2);
    out[channel] = {xx, xy, xz, x, xy, -xx, yz, y, xz, yz, zz, z, x, y, z, c4 * l(0) - c5 * l(6)};
  }
  return out;
}

Sh9MatricesF to_float(const Sh9Matrices& matrices) {
  Sh9MatricesF out{};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < 16; ++i) out[c][i] = float(matrices[c][i]);
  return out;
}

Rgb irradiance(const Sh9MatricesF& matrices, const V3f& n) {
  Rgb e;
  for (unsigned c = 0; c < 3; ++c) {
    const auto& m = matrices[c];
    const float x = m[0] * n.x + m[1] * n.y + m[2] * n.z + m[3];
    const float y = m[4] * n.x + m[5] * n.y + m[6] * n.z + m[7];
    const float z = m[8] * n.x + m[9] * n.y + m[10] * n.z + m[11];
    const float w = m[12] * n.x + m[13] * n.y + m[14] * n.z + m[15];
    e[c] = std::max(0.0F, x * n.x + y * n.y + z * n.z + w);
  }
  return e;
}

V3d minimum_irradiance(const Sh9& sh) {
  const Sh9Matrices matrices = sh9_matrices(sh);
  V3d out;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto& m = matrices[c];
    const Imath::M33d a(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
    out[int(c)] = least_on_sphere(a, V3d(m[3], m[7], m[11]), m[15]);
  }
  return out;
}

Sh9 windowed(const Sh9& sh, const Sh9Window& window) {
  Sh9 out = sh;
  for (std::size_t i = 1; i < 9; ++i) out.coefficients[i] *= band(i) == 1 ? window.band1 : window.band2;
  return out;
}

Sh9Window hann_window(double width) {
  return {0.5 * (1 + std::cos(std::numbers::pi / width)), 0.5 * (1 + std::cos(2 * std::numbers::pi / width))};
}

// The polynomials that are nowhere negative form a convex set, and for light that is nowhere negative it holds band 0
// with any part of band 2 (one directional light gives at least 1/4 - 5/32): so for each factor of band 2 the good
// factors of band 1 reach from 0 up to a largest one, which bisection finds. The change in mean square is (1 - band1)^2
// P_1 + (1 - band2)^2 P_2 with P_l the power of band l; what is left is a search along one line.
Sh9Window least_window(const Sh9& sh) {
  const auto fits = [&](const Sh9Window& window) {
    const V3d least = minimum_irradiance(windowed(sh, window));
    for (int c = 0; c < 3; ++c) {
      if (least[c] < -1e-12 * std::abs(sh.coefficients[0][c])) return false;  // rounding of sums of that size
    }
    return true;
  };
  if (fits({})) return {};
  double power1 = 0;
  double power2 = 0;
  for (std::size_t i = 1; i < 9; ++i) {
    for (int c = 0; c < 3; ++c) {
      if (sh.coefficients[0][c] == 0) continue;
      const double e = sh9_cosine[i] * sh.coefficients[i][c] / (sh9_cosine[0] * sh.coefficients[0][c]);
      (band(i) == 1 ? power1 : power2) += e * e;
    }
  }
  const auto best_with = [&](double band2) {
    double good = 0;
    double bad = 1;
    if (fits({1, band2})) return Sh9Window{1, band2};
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (good + bad);
      (fits({middle, band2}) ? good : bad) = middle;
    }
    return Sh9Window{good, band2};
  };
  const auto change = [&](const Sh9Window& window) {
    return (1 - window.band1) * (1 - window.band1) * power1 + (1 - window.band2) * (1 - window.band2) * power2;
  };
  constexpr int steps = 32;
  Sh9Window best = best_with(1);
  double spacing = 1.0 / steps;
  for (int i = steps; i-- > 0;) {
    const Sh9Window window = best_with(double(i) / steps);
    if (change(window) < change(best)) best = window;
  }
  while (spacing > 1e-6) {
    for (const double step : {-0.5, 0.5}) {
      const Sh9Window window = best_with(std::clamp(best.band2 + step * spacing, 0.0, 1.0));
      if (change(window) < change(best)) best = window;
    }
    spacing /= 2;
  }
  return best;
}

}  // namespace ivory
