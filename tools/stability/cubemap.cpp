// Localized cube maps close to walls, and polygons that the receiver's horizon cuts.
#include <algorithm>
#include <cmath>
#include <map>

#include "tools/stability/cube_builder.h"
#include "tools/stability/scenes.h"
#include "tools/stability/stability.h"

namespace ivory {
namespace {

// The part of a polygon above p's horizon, corners in order.
std::vector<V3d> above_horizon(const std::vector<V3d>& corners, const V3d& p, const V3d& n) {
  std::vector<V3d> cut;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const V3d& a = corners[i];
    const V3d& b = corners[(i + 1) % corners.size()];
    const double ha = (a - p).dot(n);
    const double hb = (b - p).dot(n);
    if (ha >= 0) cut.push_back(a);
    if ((ha >= 0) != (hb >= 0)) cut.push_back(a + (b - a) * (ha / (ha - hb)));
  }
  return cut;
}

// E in a room of 2 m about the origin whose wall at +x alone shines, 1 nit.
double wall_irradiance(const V3d& p, const V3d& n) {
  const std::vector<V3d> wall{{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}};
  return polygon_irradiance(above_horizon(wall, p, n), p, n);
}

LocalizedCube shining_wall(int size) {
  return make_cube(size, V3f(0, 0, 0), box_around(V3d(-1, -1, -1), V3d(1, 1, 1)), [](const V3f& w) {
    return w.x > std::abs(w.y) && w.x > std::abs(w.z) ? Rgb(1, 1, 1) : Rgb(0, 0, 0);
  });
}

struct CubeSeries {
  const char* name;
  CubeMethod method;
  bool bounded;
};
constexpr std::array<CubeSeries, 4> series{{{"polygons", CubeMethod::polygon, true},
                                            {"polygons, not cut", CubeMethod::polygon_paper, false},
                                            {"points", CubeMethod::point, false},
                                            {"one map, no distances", CubeMethod::convolved, false}}};

// A receiver that nears the wall, which it faces; the worst of places between a texel's centre and its corner.
std::vector<StabilityPoint> cubemap_spikes(const StabilityParams&) {
  const LocalizedCube cube = shining_wall(4);
  std::vector<StabilityPoint> points;
  for (const double distance : {0.5, 0.3, 0.2, 0.1, 0.05, 0.02, 0.01, 3e-3, 1e-3}) {
    for (const CubeSeries& s : series) {
      double worst = 0;
      for (int i = 0; i <= 8; ++i) {
        const V3d p(1 - distance, 0.25 + 0.25 * i / 8, 0.25 + 0.2 * i / 8);
        const V3d n(1, 0, 0);
        const auto e = double(irradiance(cube, s.method, V3f(p), V3f(n)).x);
        worst = std::max(worst, std::abs(e / wall_irradiance(p, n) - 1));
      }
      // A flat wall is what polygons stand for exactly: rounding.
      points.push_back({s.name, distance, worst, s.bounded ? std::optional(1e-5) : std::nullopt});
    }
  }
  return points;
}

// A receiver that turns away from the wall, so that its horizon sweeps over it.
std::vector<StabilityPoint> cubemap_horizon(const StabilityParams&) {
  const LocalizedCube cube = shining_wall(4);
  const V3d p(0.7, 0.2, -0.1);
  const double facing = wall_irradiance(p, V3d(1, 0, 0));
  std::vector<StabilityPoint> points;
  for (int step = 0; step <= 24; ++step) {
    const double angle = pi_d * step / 24;
    const V3d n(std::cos(angle), std::sin(angle) * 0.6, std::sin(angle) * 0.8);
    for (const CubeSeries& s : series) {
      const auto e = double(irradiance(cube, s.method, V3f(p), V3f(n)).x);
      const double truth = wall_irradiance(p, n);
      // A polynomial stands for atan2: 1e-6 an edge.
      points.push_back(
          {s.name, angle * 180 / pi_d, std::abs(e - truth) / facing, s.bounded ? std::optional(1e-5) : std::nullopt});
    }
  }
  // Horizons that hold an edge between texels, where a texel is neither cut nor whole. At heights 0 and 1/2 those at
  // a right angle to the wall hold theirs exactly.
  std::map<int, double> worst;  // by hundredths of a degree
  for (const double height : {0.2, 0.5, 0.0}) {
    for (const unsigned along : {1U, 2U}) {  // y or z
      V3d at(0.7, -0.1, -0.1);
      at[along] = height;
      for (int k = -2; k <= 2; ++k) {
        for (const double sign : {-1.0, 1.0}) {
          V3d across(height - k / 2.0, 0, 0);
          across[along] = 0.3;
          const V3f normal(across.normalized() * sign);
          const V3f receiver(at);
          const auto e = double(irradiance(cube, CubeMethod::polygon, receiver, normal).x);
          double& error = worst[int(std::lround(18'000 / pi_d * std::acos(double(normal.x))))];
          error = std::max(error, std::abs(e - wall_irradiance(V3d(receiver), V3d(normal))) / facing);
        }
      }
    }
  }
  for (const auto& [angle, error] : worst)
    points.push_back({"polygons, edges in the horizon", angle / 100.0, error, 1e-5});
  return points;
}

}  // namespace

std::vector<StabilityCase> stability_cubemap_cases() {
  return {
      {.name = "cubemap_spikes",
       .title = "Receivers that near a wall of a cube map",
       .sentence =
           "Texels as points spike close to walls without bound, and a map without distances is off by a third to a "
           "half; polygons are exact at any distance from flat walls: read cube maps as polygons.",
       .x_label = "distance to the wall, m (room of 2 m, 4 x 4 texels a face)",
       .y_label = "worst error / E",
       .log_x = true,
       .run = cubemap_spikes},
      {.name = "cubemap_horizon",
       .title = "Polygons that the receiver's horizon cuts",
       .sentence =
           "Where the horizon cuts texels, polygons that are not cut lose or add up to 7 % of what faces the wall; "
           "cut at the horizon, as by default, they are exact.",
       .x_label = "angle between normal and wall, degrees",
       .y_label = "error / E facing the wall",
       .run = cubemap_horizon},
  };
}

}  // namespace ivory
