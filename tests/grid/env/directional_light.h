// A directional light as moments and coefficients, and what nine coefficients keep of it.
#pragma once

#include <random>

#include "grid/env/moments.h"
#include "grid/env/sh9.h"

namespace ivory {

inline V3d random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return V3d(normal(random), normal(random), normal(random)).normalized();
}

// A directional light that gives irradiance `e` on a surface facing w: L = e delta(w).
inline Sh9 directional(const V3d& w, const V3d& e) {
  RadianceMoments m;
  m.total = e;
  m.first = {e * w.x, e * w.y, e * w.z};
  m.second = {e * (w.x * w.x), e * (w.y * w.y), e * (w.z * w.z), e * (w.x * w.y), e * (w.y * w.z), e * (w.x * w.z)};
  return sh9_from_moments(m);
}

// What the first three bands of a clamped cosine leave of a directional light: 1/4 + x/2 + 5/32 (3 x^2 - 1).
inline double three_bands(double x) { return 0.25 + 0.5 * x + 5.0 / 32 * (3 * x * x - 1); }

}  // namespace ivory
