#include "grid/export/sphere_rule.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace ivory {

namespace {

std::vector<SphereNode> make_rule() {
  constexpr int heights = 12;
  constexpr int around = 24;
  std::vector<SphereNode> nodes;
  for (int i = 0; i < heights; ++i) {
    // The roots of Legendre's polynomial by Newton's method from their asymptotic places.
    double z = std::cos(std::numbers::pi * (i + 0.75) / (heights + 0.5));
    double slope = 1;
    for (int step = 0; step < 20; ++step) {
      double p0 = 1;
      double p1 = z;
      for (int n = 2; n <= heights; ++n) {
        const double p2 = ((2 * n - 1) * z * p1 - (n - 1) * p0) / n;
        p0 = p1;
        p1 = p2;
      }
      slope = heights * (z * p1 - p0) / (z * z - 1);
      z -= p1 / slope;
    }
    const double weight = 2 / ((1 - z * z) * slope * slope) * 2 * std::numbers::pi / around;
    const double r = std::sqrt(1 - z * z);
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.5) / around;
      nodes.push_back({V3d(r * std::cos(angle), r * std::sin(angle), z), weight});
    }
  }
  return nodes;
}

}  // namespace

std::span<const SphereNode> sphere_rule() {
  static const std::vector<SphereNode> nodes = make_rule();
  return nodes;
}

}  // namespace ivory
