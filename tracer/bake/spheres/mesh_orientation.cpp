#include "tracer/bake/spheres/mesh_orientation.h"

#include <algorithm>
#include <cmath>

namespace ivory {

namespace {

// Where rays along one axis meet the mesh: sorted depths, a list for each cell of a grid across that axis.
struct Crossings {
  int axis = 0;
  int width = 0;
  int height = 0;
  double cell = 1;
  std::vector<std::vector<float>> depths;

  int u() const { return (axis + 1) % 3; }
  int v() const { return (axis + 2) % 3; }

  // Is the number of surfaces between p and the far end odd?
  bool inside(const V3d& p) const {
    const int i = int(std::floor(p[u()] / cell));
    const int j = int(std::floor(p[v()] / cell));
    if (i < 0 || j < 0 || i >= width || j >= height) return false;
    const std::vector<float>& list = depths[std::size_t(j) * std::size_t(width) + std::size_t(i)];
    return (list.end() - std::upper_bound(list.begin(), list.end(), float(p[axis]))) % 2 == 1;
  }
};

Crossings cross_along(const std::vector<Triangle3d>& triangles, const V3d& size, int axis, int resolution) {
  Crossings c;
  c.axis = axis;
  c.cell = 1.0 / resolution;
  c.width = std::max(1, int(std::ceil(size[c.u()] * resolution)));
  c.height = std::max(1, int(std::ceil(size[c.v()] * resolution)));
  c.depths.resize(std::size_t(c.width) * std::size_t(c.height));
  for (const Triangle3d& t : triangles) {
    double low[2], high[2];
    for (int k = 0; k < 2; ++k) {
      const int a = k == 0 ? c.u() : c.v();
      low[k] = std::min({t[0][a], t[1][a], t[2][a]});
      high[k] = std::max({t[0][a], t[1][a], t[2][a]});
    }
    // Rays pass near the cells' centres, off the edges that models like to put on round numbers.
    constexpr double center_u = 0.5 + 0.0137;
    constexpr double center_v = 0.5 - 0.0291;
    const int i0 = std::max(0, int(std::ceil(low[0] / c.cell - center_u)));
    const int i1 = std::min(c.width - 1, int(std::floor(high[0] / c.cell - center_u)));
    const int j0 = std::max(0, int(std::ceil(low[1] / c.cell - center_v)));
    const int j1 = std::min(c.height - 1, int(std::floor(high[1] / c.cell - center_v)));
    for (int j = j0; j <= j1; ++j) {
      for (int i = i0; i <= i1; ++i) {
        const double x = (i + center_u) * c.cell;
        const double y = (j + center_v) * c.cell;
        const auto edge = [&](const V3d& a, const V3d& b) {
          return (b[c.u()] - a[c.u()]) * (y - a[c.v()]) - (b[c.v()] - a[c.v()]) * (x - a[c.u()]);
        };
        const double w0 = edge(t[1], t[2]);
        const double w1 = edge(t[2], t[0]);
        const double w2 = edge(t[0], t[1]);
        const bool within = (w0 > 0 && w1 > 0 && w2 > 0) || (w0 < 0 && w1 < 0 && w2 < 0);
        if (!within) continue;
        const double depth = (w0 * t[0][axis] + w1 * t[1][axis] + w2 * t[2][axis]) / (w0 + w1 + w2);
        c.depths[std::size_t(j) * std::size_t(c.width) + std::size_t(i)].push_back(float(depth));
      }
    }
  }
  for (std::vector<float>& list : c.depths) std::sort(list.begin(), list.end());
  return c;
}

}  // namespace

void orient_by_parity(std::vector<Triangle3d>& triangles, const V3d& size, int resolution) {
  const Crossings along[3] = {cross_along(triangles, size, 0, resolution), cross_along(triangles, size, 1, resolution),
                              cross_along(triangles, size, 2, resolution)};
  const auto inside = [&](const V3d& p) {
    return int(along[0].inside(p)) + int(along[1].inside(p)) + int(along[2].inside(p)) >= 2;
  };
  for (Triangle3d& t : triangles) {
    const V3d n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    const V3d middle = (t[0] + t[1] + t[2]) / 3.0;
    // A ray stands for its whole cell: a step of two cells off the surface tells the sides apart.
    const V3d step = n * (2.0 / resolution);
    if (inside(middle + step) && !inside(middle - step)) std::swap(t[1], t[2]);
  }
}

}  // namespace ivory
