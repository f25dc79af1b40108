// Localized cube maps where formulas end: on the shell and beyond it, at corners, at the ends of floats.
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "grid/cubemap/localized.h"
#include "tools/stability/cube_builder.h"

namespace ivory {
namespace {

TEST(LocalizedCube, PointHasSpikesAndPolygonHasNone) {
  const LocalizedCube cube = make_cube(4, V3f(0, 0, 0), box_around(V3d(-1), V3d(1)), white);
  double brightest = 0;
  for (int i = 0; i < 100; ++i) {
    // Towards a texel's centre on the wall.
    const V3f p(0.25F, 0.25F, 0.0099F * float(i));
    brightest = std::max(brightest, double(irradiance(cube, CubeMethod::point, p, V3f(0, 0, 1)).x));
    EXPECT_NEAR(irradiance(cube, CubeMethod::polygon, p, V3f(0, 0, 1)).x, pi, 1e-3);
  }
  EXPECT_GT(brightest, 100 * pi);
}

// Continuous across the shell, and no brighter outside than what shines.
TEST(LocalizedCube, OutsideReadsTheShell) {
  std::mt19937 random(5);
  const LocalizedCube cube = make_cube(4, V3f(3, 4, 5), box_around(V3d(-1, -2, -1), V3d(1, 1, 3)),
                                       [](const V3f& w) { return Rgb(1 + w.x, 1 + w.y, 1 + w.z); });
  for (int i = 0; i < 1000; ++i) {
    const V3f w = random_unit(random);
    const V3f n = random_unit(random);
    const V3f edge = inside_shell(cube, w * 1e6F);
    const Rgb inside = irradiance(cube, CubeMethod::polygon, cube.origin_m + edge * 0.99999F, n);
    for (const float farther : {1.0001F, 1.1F, 100.0F, 1e20F}) {
      const Rgb outside = irradiance(cube, CubeMethod::polygon, cube.origin_m + edge * farther, n);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(outside[c], inside[c], 0.01F);
        EXPECT_LE(outside[c], 2 * pi);
      }
    }
  }
}

// Whatever comes in, what goes out is a number that light can be.
TEST(LocalizedCube, NothingMakesItFail) {
  const char* chosen = std::getenv("IVORY_MANY");  // 10000000: ten million
  const int many = chosen != nullptr ? std::atoi(chosen) : 1'000'000;
  std::mt19937 random(6);
  std::uniform_real_distribution<float> unit(0, 1);
  constexpr float inf = std::numeric_limits<float>::infinity();
  const auto pick = [&](const std::vector<float>& from) { return from[random() % from.size()]; };
  const auto adversarial = [&](float x) {
    const float special = pick({0, -0.0F, 1, -1, 1e-38F, 1e-20F, -1e-6F, 1e6F, -1e20F, 3e38F, inf, std::nanf("")});
    return random() % 3 == 0 ? special : x;
  };
  constexpr CubeMethod methods[] = {CubeMethod::convolved, CubeMethod::point, CubeMethod::polygon,
                                    CubeMethod::polygon_paper};
  LocalizedCube cube;
  V3f vertex;
  for (int i = 0; i < many; ++i) {
    if (i % 64 == 0) {
      const int kind = int(random() % 4);
      const float scale = std::pow(10.0F, 12 * unit(random) - 6);
      cube = make_cube(
          1 << random() % 3, random() % 2 == 0 ? V3f(0, 0, 0) : random_unit(random) * scale * 10.0F,
          [&](const V3d& w) {
            if (kind == 0) return std::min(box_around(V3d(-0.5), V3d(1))(w) / scale, 0.5e6F);
            if (kind == 1) return pick({0.0F, 1e-30F, 1e-6F, 1, 0.5e6F});
            return kind == 2 ? 0.0F : float(w.y > 0 ? 0 : 1 / scale);
          },
          [&](const V3f&) {
            return random() % 4 == 0 ? Rgb(0, greatest_radiance_nits, 1e-30F) : Rgb(unit(random), 1, 0);
          });
    }
    const int size = cube.radiance.size;
    const int face = int(random() % 6);
    const int row = int(random() % unsigned(size));
    const int column = int(random() % unsigned(size));
    const TexelCorners& v = cube.corners[cube_index(size, face, row, column)];
    const V3f q(cube_point(face, cube_edge(size, column), cube_edge(size, row)));
    vertex = v[0] > 0 ? q / v[0] : q;
    V3f p = cube.origin_m + vertex * pick({0, 0.5F, 0.999F, 1, 1.001F, 2});
    // On an edge, on a corner's own coordinates, anywhere.
    if (random() % 4 == 0) p = V3f(adversarial(p.x), adversarial(p.y), adversarial(p.z));
    V3f n = random_unit(random);
    if (random() % 4 == 0) n = cube_face_axes(int(random() % 6)).forward;
    if (random() % 8 == 0 && vertex.length() > 0 && vertex.length() < inf) n = vertex.normalized();
    const Rgb e = irradiance(cube, methods[i % 4], p, n);
    for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(e[c]) && e[c] >= 0) << i << " " << p << n << e;
  }
}

}  // namespace
}  // namespace ivory
