#include "grid/env/angular_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace ivory {

namespace {

double sinc(double x) { return x < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x; }

}  // namespace

V3d angular_direction(double u, double v) {
  const double theta = std::numbers::pi * std::sqrt(u * u + v * v);
  const double scale = std::numbers::pi * sinc(theta);  // sin(theta) over the radius
  return {-u * scale, -v * scale, std::cos(theta)};
}

std::size_t angular_texel(int size, const V3f& w) {
  const float across = std::sqrt(w.x * w.x + w.y * w.y);
  const float radius = std::atan2(across, w.z) / pi;
  const float u = across > 0 ? -w.x / across * radius : radius;
  const float v = across > 0 ? -w.y / across * radius : 0.0F;
  const auto texel = [size](float x) { return std::clamp(int((x + 1) * 0.5F * float(size)), 0, size - 1); };
  return std::size_t(texel(v)) * std::size_t(size) + std::size_t(texel(u));
}

std::vector<AngularNode> angular_nodes(int size, int row, int column) {
  const double width = 2.0 / size;
  const double u0 = -1 + width * column;
  const double v0 = -1 + width * row;
  const auto radius2 = [](double u, double v) { return u * u + v * v; };
  const double far_u = std::max(std::abs(u0), std::abs(u0 + width));
  const double far_v = std::max(std::abs(v0), std::abs(v0 + width));
  const double near_u = u0 * (u0 + width) < 0 ? 0 : std::min(std::abs(u0), std::abs(u0 + width));
  const double near_v = v0 * (v0 + width) < 0 ? 0 : std::min(std::abs(v0), std::abs(v0 + width));

  std::vector<AngularNode> nodes;
  const auto add = [&](double u, double v, double area) {
    const double theta = std::numbers::pi * std::sqrt(radius2(u, v));
    nodes.push_back({angular_direction(u, v), std::numbers::pi * std::numbers::pi * std::max(0.0, sinc(theta)) * area});
  };
  if (radius2(near_u, near_v) >= 1) return nodes;
  if (radius2(far_u, far_v) <= 1) {
    constexpr std::array<double, 3> point{0.11270166537925831, 0.5, 0.88729833462074169};
    constexpr std::array<double, 3> weight{5.0 / 18, 8.0 / 18, 5.0 / 18};
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t i = 0; i < 3; ++i)
        add(u0 + width * point[i], v0 + width * point[j], width * width * weight[i] * weight[j]);
    }
  } else {
    constexpr int n = 8;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const double u = u0 + width * (i + 0.5) / n;
        const double v = v0 + width * (j + 0.5) / n;
        if (radius2(u, v) < 1) add(u, v, width * width / (n * n));
      }
    }
  }
  return nodes;
}

}  // namespace ivory
