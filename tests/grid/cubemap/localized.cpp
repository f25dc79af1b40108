// Localized cube maps against closed forms: closed shells of constant radiance, one lit rectangle.
#include "grid/cubemap/localized.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tools/stability/cube_builder.h"

namespace ivory {
namespace {

// How far the weights of all texels are from pi. E of the whole shell is bounded by pi L, which would hide weights
// that sum to more; so one texel is made brighter, which lifts the bound, and its own light taken off again.
double partition_error(LocalizedCube cube, const V3f& p, const V3f& n, std::size_t any) {
  Rgb& texel = cube.radiance.texels[any % cube.radiance.texels.size()];
  const double plain = irradiance(cube, CubeMethod::polygon, p, n).x;
  texel = Rgb(4, 4, 4);
  const double lifted = irradiance(cube, CubeMethod::polygon, p, n).x;
  for (Rgb& other : cube.radiance.texels) {
    if (&other != &texel) other = Rgb(0, 0, 0);
  }
  const double own = irradiance(cube, CubeMethod::polygon, p, n).x * 3 / 4;
  // Where the texel counts negative, on a fold, its own light is 0 and says nothing.
  return std::max(std::abs(plain / pi - 1), own > 0 ? std::abs((lifted - own) / pi - 1) : 0.0);
}

constexpr int sizes[] = {1, 2, 4, 8};

// Rounding alone: a few hundred terms of up to pi, each within some 1e-7. Directions to a wall lose the digits
// by which the point is nearer to it than the texel is large: three for boxes this narrow.
constexpr double closed_tolerance = 1e-3;

TEST(LocalizedCube, ClosedBoxOfConstantRadianceGivesPi) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const int size : sizes) {
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
      // A box of any proportions around a reference point anywhere in it.
      float u[6];  // one by one: compilers evaluate arguments in orders of their own
      for (float& number : u) number = unit(random);
      const V3f low(-0.01F - 3 * u[0], -0.01F - u[1], -0.01F - 10 * u[2]);
      const V3f high(0.01F + 3 * u[3], 0.01F + u[4], 0.01F + 10 * u[5]);
      const LocalizedCube cube = make_cube(size, V3f(5, 6, -7), box_around(V3d(low), V3d(high)), white);
      V3f offset;
      for (int c = 0; c < 3; ++c) offset[c] = low[c] + (high[c] - low[c]) * unit(random);
      const V3f n = random_unit(random);
      worst = std::max(worst, partition_error(cube, cube.origin_m + offset, n, random()));
    }
    EXPECT_LT(worst, closed_tolerance) << size;
  }
}

// A shell that folds over itself as seen from most points: random distances, some of them endless.
TEST(LocalizedCube, FoldedAndOpenShellsOfConstantRadianceGivePi) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const int size : sizes) {
    double worst = 0;
    for (int i = 0; i < 5000; ++i) {
      const double key = 1000 * unit(random);
      const bool endless = i % 2 == 1;
      const LocalizedCube cube = make_cube(
          size, V3f(0, 0, 0),
          [&](const V3d& w) {
            const double u = std::abs(std::sin(12.9898 * w.x + 78.233 * w.y + 37.719 * w.z + key));
            return endless && u < 0.4 ? 0.0F : float(0.3 + u);
          },
          white);
      const V3f p = random_unit(random) * (3 * unit(random));
      const V3f n = random_unit(random);
      worst = std::max(worst, partition_error(cube, p, n, random()));
    }
    EXPECT_LT(worst, closed_tolerance) << size;
  }
}

// The square faces of a cube of half side 2 around the origin, of which a block of texels of +Z is lit.
struct LitRectangle {
  int size, row0, row1, column0, column1;  // texels row0 .. row1 - 1, column0 .. column1 - 1

  LocalizedCube cube(const V3f& origin) const {
    LocalizedCube map = make_cube(size, origin, box_around(V3d(-2), V3d(2)), [](const V3f&) { return Rgb(0, 0, 0); });
    for (int row = row0; row < row1; ++row) {
      for (int column = column0; column < column1; ++column)
        map.radiance.texels[cube_index(size, 4, row, column)] = Rgb(1, 1, 1);
    }
    return map;
  }
  // Of its points in the plane z = 2; columns grow towards -x, rows towards -y.
  double x(double column) const { return -2 * (2 * column - size) / size; }
  double y(double row) const { return -2 * (2 * row - size) / size; }
};

// Integral of cos cos' / r^2 over the rectangle, by the midpoint rule in double; relative error near 1e-5, a few 1e-5
// of the largest value where the horizon cuts.
double rectangle_irradiance(const LitRectangle& lit, const V3d& p, const V3d& n) {
  constexpr int steps = 800;
  const double x0 = lit.x(lit.column0);
  const double y0 = lit.y(lit.row0);
  const double dx = (lit.x(lit.column1) - x0) / steps;
  const double dy = (lit.y(lit.row1) - y0) / steps;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    for (int k = 0; k < steps; ++k) {
      const V3d r = V3d(x0 + (i + 0.5) * dx, y0 + (k + 0.5) * dy, 2) - p;
      const double r2 = r.dot(r);
      sum += std::max(0.0, r.dot(n)) * r.z / (r2 * r2);
    }
  }
  return sum * std::abs(dx * dy);
}

// Howell's catalogue of configuration factors, C-11: a parallel element below the corner of a rectangle a by b at
// distance c.
double corner_factor(double a, double b, double c) {
  const double x = a / c;
  const double y = b / c;
  const double rx = std::sqrt(1 + x * x);
  const double ry = std::sqrt(1 + y * y);
  return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2 * 3.14159265358979);
}

TEST(LocalizedCube, RectangleFacingTheReceiverHasTheTextbookFormFactor) {
  const LitRectangle lit{8, 2, 5, 1, 7};
  const V3f origin(100, -50, 30);
  const LocalizedCube cube = lit.cube(origin);
  for (const V3f& p : {V3f(0, 0, 0), V3f(0.3F, -0.2F, 1.5F), V3f(-1.7F, 1.2F, -1.9F), V3f(0.2F, 0.2F, 1.99F)}) {
    // Four rectangles with a corner above p, signed.
    double factor = 0;
    for (const auto& [x, sx] : {std::pair(lit.x(lit.column0), 1), std::pair(lit.x(lit.column1), -1)}) {
      for (const auto& [y, sy] : {std::pair(lit.y(lit.row0), 1), std::pair(lit.y(lit.row1), -1)})
        factor += sx * sy * corner_factor(x - double(p.x), y - double(p.y), 2 - double(p.z));
    }
    for (const CubeMethod method : {CubeMethod::polygon, CubeMethod::polygon_paper}) {
      const Rgb e = irradiance(cube, method, origin + p, V3f(0, 0, 1));
      // Positions 100 m from the world's origin are rounded to 4e-6 m, here of 0.01 m at the nearest.
      EXPECT_NEAR(e.x / pi / factor, 1, 1e-3) << p << std::string(name_of(method));
    }
  }
}

TEST(LocalizedCube, RectangleTiltedThroughTheHorizon) {
  double worst = 0;
  double paper_worst = 0;
  for (const LitRectangle& lit :
       {LitRectangle{2, 0, 1, 1, 2}, LitRectangle{4, 1, 3, 0, 3}, LitRectangle{8, 2, 5, 1, 7}}) {
    const LocalizedCube cube = lit.cube(V3f(0, 0, 0));
    for (const V3f& p : {V3f(0, 0, 0), V3f(0.4F, -0.7F, 1.2F), V3f(1.5F, 1.1F, -1.0F)}) {
      const double facing = rectangle_irradiance(lit, V3d(p), V3d(0, 0, 1));
      for (int degrees = 0; degrees <= 180; degrees += 10) {
        const double angle = degrees * 3.14159265358979 / 180;
        // About an axis that is neither an edge nor a diagonal.
        const V3d n(std::sin(angle) * 0.8, std::sin(angle) * 0.6, std::cos(angle));
        const double truth = rectangle_irradiance(lit, V3d(p), n);
        const double polygon = irradiance(cube, CubeMethod::polygon, p, V3f(n)).x;
        worst = std::max(worst, std::abs(polygon - truth) / facing);
        EXPECT_NEAR(polygon / facing, truth / facing, 1e-3) << lit.size << " " << p << " " << degrees;
        const double paper = irradiance(cube, CubeMethod::polygon_paper, p, V3f(n)).x;
        paper_worst = std::max(paper_worst, std::abs(paper - truth) / facing);
      }
    }
  }
  // What leaving the cut out costs; in units of E of the receiver that faces the rectangle.
  EXPECT_GT(paper_worst, 0.03);
  RecordProperty("worst", std::to_string(worst));
  RecordProperty("paper_worst", std::to_string(paper_worst));
}

// The shell as a list of triangles, in double, and rays against all of them.
double traced_irradiance(const LocalizedCube& cube, const V3d& p, const V3d& n, int rays) {
  const int size = cube.radiance.size;
  const double golden = 3.14159265358979 * (3 - std::sqrt(5.0));
  double sum = 0;
  for (int ray = 0; ray < rays; ++ray) {
    const double z = 1 - (2.0 * ray + 1) / rays;
    const double radius = std::sqrt(1 - z * z);
    const V3d w(radius * std::cos(golden * ray), z, radius * std::sin(golden * ray));
    if (!(w.dot(n) > 0)) continue;
    for (int face = 0; face < cube_faces; ++face) {
      for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) {
          const std::size_t i = cube_index(size, face, row, column);
          V3d corner[4];
          for (int k = 0; k < 4; ++k) {
            corner[k] =
                V3d(cube.origin_m) + cube_point(face, cube_edge(size, column + k % 2), cube_edge(size, row + k / 2)) /
                                         double(cube.corners[i][std::size_t(k)]);
          }
          for (const auto& [a, b, c] : {std::tuple(0, 1, 3), std::tuple(0, 3, 2)}) {
            const V3d ra = corner[a] - p;
            const V3d rb = corner[b] - p;
            const V3d rc = corner[c] - p;
            const double wa = w.dot(rb.cross(rc));
            const double wb = w.dot(rc.cross(ra));
            const double wc = w.dot(ra.cross(rb));
            const double facing = ra.dot(rb.cross(rc)) > 0 ? 1 : -1;
            if (wa * facing > 0 && wb * facing > 0 && wc * facing > 0)
              sum += facing * double(cube.radiance.texels[i].x) * w.dot(n);
          }
        }
      }
    }
  }
  return sum * 4 * 3.14159265358979 / rays;
}

TEST(LocalizedCube, PolygonAgreesWithRaysThroughTheShell) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < 12; ++i) {
    const LocalizedCube cube = make_cube(1 + i % 4, V3f(1, 2, 3), box_around(V3d(-1, -0.5, -2), V3d(0.7, 1.5, 1)),
                                         [&](const V3f&) { return Rgb(unit(random), 0, 0); });
    const V3f p = cube.origin_m + V3f(unit(random) - 0.6F, unit(random) - 0.3F, unit(random) - 0.7F);
    const V3f n = random_unit(random);
    // 20,000 rays, each radiance's border cut by some; errors of 3e-3 are the quadrature's.
    EXPECT_NEAR(irradiance(cube, CubeMethod::polygon, p, n).x, traced_irradiance(cube, V3d(p), V3d(n), 20000), 0.01)
        << i;
  }
}

TEST(LocalizedCube, MethodsAgreeWhereTheyMust) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(0, 1);
  const Depth room = box_around(V3d(-1, -1.5, -2), V3d(2, 1, 1));
  const Light gradient = [](const V3f& w) { return Rgb(1.5F + w.x, 1.5F + w.y, 1.5F - w.z); };
  const LocalizedCube cube = make_cube(8, V3f(0, 0, 0), room, gradient);
  const LocalizedCube sky = make_cube(
      8, V3f(0, 0, 0), [](const V3d&) { return 0.0F; }, gradient);
  for (int i = 0; i < 100; ++i) {
    const V3f n = random_unit(random);
    const V3f p(unit(random) - 0.5F, unit(random) - 0.5F, unit(random) - 0.5F);
    const Rgb convolved = irradiance(cube, CubeMethod::convolved, p, n);
    // At the reference point distances do not matter; under the sky, the place does not.
    const Rgb at_origin = irradiance(cube, CubeMethod::polygon, cube.origin_m, n);
    const Rgb under_sky = irradiance(sky, CubeMethod::polygon, p * 1000.0F, n);
    // Radiance 1.5 + n.w leaves 1.5 pi + 2/3 pi n.w, of texels of constant radiance to their size squared.
    const Rgb exact(pi * (1.5F + n.x / 1.5F), pi * (1.5F + n.y / 1.5F), pi * (1.5F - n.z / 1.5F));
    const Rgb patches = irradiance(cube, CubeMethod::point, cube.origin_m, n);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(convolved[c] / at_origin[c], 1, 1e-5);
      EXPECT_NEAR(under_sky[c] / at_origin[c], 1, 1e-4);
      EXPECT_NEAR(at_origin[c] / exact[c], 1, 0.01);
      EXPECT_NEAR(patches[c] / exact[c], 1, 0.03);
    }
  }
}

TEST(LocalizedCube, FaultsAreFound) {
  const LocalizedCube good = make_cube(3, V3f(0, 0, 0), box_around(V3d(-1), V3d(2)), white);
  EXPECT_EQ(find_fault(good), "");
  const auto fault = [&](const std::function<void(LocalizedCube&)>& change) {
    LocalizedCube cube = good;
    change(cube);
    return find_fault(cube);
  };
  EXPECT_NE(fault([](LocalizedCube& cube) { cube.corners[7][2] *= 1.5F; }), "");
  EXPECT_NE(fault([](LocalizedCube& cube) { cube.corners[7][2] = -1; }), "");
  EXPECT_NE(fault([](LocalizedCube& cube) { cube.radiance.texels[5].y = std::nanf(""); }), "");
  EXPECT_NE(fault([](LocalizedCube& cube) { cube.corners.pop_back(); }), "");
  EXPECT_NE(fault([](LocalizedCube& cube) { cube.origin_m.x = std::numeric_limits<float>::infinity(); }), "");
  for (const int size : {1, 2, 5}) {
    const auto vertices = corner_vertices(size);
    EXPECT_EQ(*std::max_element(vertices.begin(), vertices.end()) + 1, 6 * size * size + 2);
  }
}

TEST(LocalizedCube, MethodsHaveNames) {
  for (const CubeMethod method :
       {CubeMethod::convolved, CubeMethod::point, CubeMethod::polygon, CubeMethod::polygon_paper})
    EXPECT_EQ(from_name<CubeMethod>(name_of(method)), method);
  EXPECT_THROW(from_name<CubeMethod>("nonsense"), ParameterError);
}

}  // namespace
}  // namespace ivory
