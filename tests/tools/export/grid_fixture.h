// Grids to export, places to compare at, and how far off a reader is there.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "grid/field/guard.h"
#include "grid/field/lookup.h"
#include "grid/io/vdb/vdb.h"
#include "tests/support/command_test.h"

namespace ivory {

struct Point {
  V3f p;
  V3f n;
};

inline V3f random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return V3f(normal(random), normal(random), normal(random)).normalized();
}

// Do all eight vertices around p know light, and see p and each other?
inline bool in_the_open(const IrradianceGrid& grid, const V3f& p) {
  const V3f index = grid.frame.to_index(p);
  for (int axis = 0; axis < 3; ++axis)
    if (index[axis] < 0 || index[axis] > float(grid.frame.size[axis] - 1)) return false;
  const Footprint footprint = make_footprint(grid.frame, p, Interpolation::trilinear);
  for (std::size_t i = 0; i < 8; ++i) {
    const std::uint32_t v = footprint.vertex[i];
    const V3f at(grid.frame.vertex_coordinates(v));
    if (grid.visible_fraction[v] < 0.25F || hidden_by(grid.guard[v], index - at) > 0) return false;
    for (std::size_t k = 0; k < 8; ++k)
      if (hidden_by(grid.guard[v], V3f(grid.frame.vertex_coordinates(footprint.vertex[k])) - at) > 0) return false;
    if (is_black(irradiance(grid, footprint, V3f(0, 1, 0), Reconstruction::optimal))) return false;
  }
  return true;
}

class ExportGrid : public CommandTest {
 protected:
  IrradianceGrid bake(const std::string& scene_file, const std::string& options) const {
    run("bake grid " + scene_file + " -o " + path("g.vdb") + " --force --photons 300k " + options);
    return read_grid_vdb(path("g.vdb"));
  }
  nlohmann::json export_to(const std::string& target, const std::string& output, const std::string& more = {}) const {
    return run("export " + path("g.vdb") + " --to " + target + " -o " + path(output) + " --force " + more);
  }
  static Rgb truth(const IrradianceGrid& grid, const V3f& p, const V3f& n) {
    LookupParams params;
    params.nudge_voxels = 0;
    return lookup_irradiance(grid, p, V3f(0, 0, 0), n, params);
  }
  // 200 points off the walls whose footprints, and those where three.js looks, are in the open.
  static std::vector<Point> points_of(const IrradianceGrid& grid, bool along_axes, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<Point> points;
    for (int i = 0; i < 100000 && points.size() < 200; ++i) {
      V3f index;
      for (int axis = 0; axis < 3; ++axis) index[axis] = uniform(random) * float(grid.frame.size[axis] - 1);
      const V3f p = grid.frame.to_world(index);
      V3f n = random_direction(random);
      if (along_axes) {
        n = V3f(0, 0, 0);
        n[i % 3] = i % 2 != 0 ? -1.0F : 1.0F;
      }
      if (in_the_open(grid, p) && in_the_open(grid, p + n * grid.frame.spacing_m * 0.5F)) points.push_back({p, n});
    }
    EXPECT_EQ(points.size(), 200U);
    return points;
  }
  // RMS of reader(p, n), E in lux, less that of the grid at the same place, over mean E.
  template <typename Reader, typename Truth>
  static double relative_rms(const std::vector<Point>& points, const Reader& reader, const Truth& e_of) {
    double squares = 0;
    double sum = 0;
    for (const Point& at : points) {
      const V3d e(e_of(at));
      squares += (reader(V3d(at.p), V3d(at.n)) - e).length2() / 3;
      sum += (e.x + e.y + e.z) / 3;
    }
    return std::sqrt(squares / double(points.size())) / (sum / double(points.size()));
  }
};

}  // namespace ivory
