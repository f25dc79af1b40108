// Cube maps: orientation, exact solid angles, texels and directions, the seamless look-up.
#include "grid/env/cube_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>

namespace ivory {
namespace {

constexpr double pi_d = 3.14159265358979323846;

V3f random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return V3f(normal(random), normal(random), normal(random)).normalized();
}

TEST(CubeMap, FacesLookAlongTheirAxesAndAreNotMirrored) {
  const std::array<V3f, 6> forward{V3f(1, 0, 0),  V3f(-1, 0, 0), V3f(0, 1, 0),
                                   V3f(0, -1, 0), V3f(0, 0, 1),  V3f(0, 0, -1)};
  for (int face = 0; face < cube_faces; ++face) {
    const CubeFaceAxes& axes = cube_face_axes(face);
    EXPECT_EQ(axes.forward, forward[std::size_t(face)]);
    // Seen from inside by a right-handed eye, right = forward x up.
    EXPECT_EQ(axes.right, axes.forward.cross(-axes.down)) << face;
  }
}

// ImfEnvmap's faces: the row and column of a point, read off its definition for each face.
TEST(CubeMap, FacesLieAsInOpenExr) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const V3f w = random_direction(random);
    const CubePosition p = cube_position(w);
    const V3f c = w / std::max({std::abs(w.x), std::abs(w.y), std::abs(w.z)});
    const std::array<V2f, 6> expected{V2f(c.z, -c.y), V2f(-c.z, -c.y), V2f(c.x, -c.z),
                                      V2f(c.x, c.z),  V2f(-c.x, -c.y), V2f(c.x, -c.y)};
    EXPECT_NEAR(p.s, expected[std::size_t(p.face)].x, 1e-6);
    EXPECT_NEAR(p.t, expected[std::size_t(p.face)].y, 1e-6);
  }
}

TEST(CubeMap, PositionInvertsPoint) {
  std::mt19937 random(2);
  for (int i = 0; i < 10000; ++i) {
    const V3f w = random_direction(random);
    const CubePosition p = cube_position(w);
    // A few float roundings of a quotient.
    EXPECT_LT((V3f(cube_point(p.face, p.s, p.t).normalized()) - w).length(), 5e-7F);
  }
  EXPECT_EQ(cube_position({0, 0, 0}).face, 0);
  EXPECT_EQ(cube_position({1, 1, 1}).face, 0);
  EXPECT_EQ(cube_position({0, -1, 1}).face, 3);
}

TEST(CubeMap, CentresLieInTheirTexels) {
  for (const int size : {1, 2, 3, 32, 129}) {
    std::size_t index = 0;
    for (int face = 0; face < cube_faces; ++face)
      for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column)
          ASSERT_EQ(cube_texel(size, cube_texel_direction(size, face, row, column)), index++) << size;
  }
}

TEST(CubeMap, SolidAnglesSumToTheSphere) {
  for (const int size : {1, 2, 3, 32, 1000}) {
    double sum = 0;
    for (int row = 0; row < size; ++row)
      for (int column = 0; column < size; ++column) sum += cube_texel_solid_angle(size, row, column);
    // size^2 differences of numbers near one, rounded to 1e-16 each.
    EXPECT_NEAR(6 * sum, 4 * pi_d, 1e-12) << size;
  }
  EXPECT_NEAR(cube_texel_solid_angle(1, 0, 0), 4 * pi_d / 6, 1e-15);
}

TEST(CubeMap, SolidAngleIsTheIntegralOfItsDensity) {
  // Midpoint rule, 400 x 400: relative error of order (1/400)^2 / 24 times curvature below 10.
  const int size = 5;
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      double sum = 0;
      constexpr int n = 400;
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          const double s = cube_edge(size, column) + 2.0 / size * (i + 0.5) / n;
          const double t = cube_edge(size, row) + 2.0 / size * (j + 0.5) / n;
          sum += std::pow(1 + s * s + t * t, -1.5);
        }
      }
      sum *= 4.0 / (size * size) / (n * n);
      EXPECT_NEAR(cube_texel_solid_angle(size, row, column), sum, sum * 1e-6);
    }
  }
}

// Unit directions of a texel's corners: top left, top right, bottom right, bottom left.
std::array<V3f, 4> cube_texel_corners(int size, int face, int row, int column) {
  const double s0 = cube_edge(size, column);
  const double s1 = cube_edge(size, column + 1);
  const double t0 = cube_edge(size, row);
  const double t1 = cube_edge(size, row + 1);
  // Normalised from the sum of squares in a fixed order of axes: the same point of a seam gives the same bits
  // whichever face asks.
  const auto unit = [face](double s, double t) { return V3f(cube_point(face, s, t).normalized()); };
  return {unit(s0, t0), unit(s1, t0), unit(s1, t1), unit(s0, t1)};
}

TEST(CubeMap, NeighboursShareTheirCornersExactly) {
  const int size = 7;
  std::map<std::array<float, 3>, int> uses;
  for (int face = 0; face < cube_faces; ++face)
    for (int row = 0; row < size; ++row)
      for (int column = 0; column < size; ++column)
        for (const V3f& c : cube_texel_corners(size, face, row, column)) ++uses[{c.x + 0.0F, c.y + 0.0F, c.z + 0.0F}];
  // V - E + F = 2 with E = 2 F quadrilateral faces: F + 2 vertices; three texels meet at the cube's eight corners.
  EXPECT_EQ(uses.size(), std::size_t(6 * size * size + 2));
  int threes = 0;
  for (const auto& [corner, count] : uses) {
    EXPECT_TRUE(count == 4 || count == 3);
    threes += count == 3 ? 1 : 0;
  }
  EXPECT_EQ(threes, 8);
}

TEST(CubeMap, CornersRunClockwiseSeenFromInside) {
  for (int face = 0; face < cube_faces; ++face) {
    const auto c = cube_texel_corners(4, face, 1, 2);
    const V3f centre = cube_texel_direction(4, face, 1, 2);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_GT(c[i].cross(c[(i + 1) % 4]).dot(centre), 0) << face;
  }
}

CubeMap random_map(int size) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> value;
  CubeMap map{size, std::vector<Rgb>(std::size_t(6 * size * size))};
  for (Rgb& texel : map.texels) texel = Rgb(value(random), value(random), value(random));
  return map;
}

TEST(CubeMap, BilinearReadsTexelsAtTheirCentres) {
  for (const int size : {1, 2, 5}) {
    const CubeMap map = random_map(size);
    std::size_t index = 0;
    for (int face = 0; face < cube_faces; ++face)
      for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column, ++index) {
          const Rgb value = bilinear(map, cube_texel_direction(size, face, row, column));
          EXPECT_NEAR(value.x, map.texels[index].x, 2e-6) << size;
        }
  }
}

TEST(CubeMap, BilinearIsContinuousAcrossSeamsAndCorners) {
  std::mt19937 random(4);
  for (const int size : {1, 2, 3, 16}) {
    const CubeMap map = random_map(size);
    for (int i = 0; i < 20000; ++i) {
      V3f w = random_direction(random);
      // Onto an edge of the cube, every fourth onto a corner.
      const unsigned a = unsigned(i) % 3;
      const unsigned b = (a + 1) % 3;
      const unsigned c = (a + 2) % 3;
      w[b] = std::copysign(w[a], w[b]);
      if (i % 4 == 0) w[c] = std::copysign(w[a], w[c]);
      const float step = 1e-5F;
      const V3f d = random_direction(random) * (step * std::abs(w[a]));
      const Rgb difference = bilinear(map, w + d) - bilinear(map, w - d);
      // Slopes are below two values a texel of 2/size, and half as much again for the corner's mean.
      EXPECT_LT(std::abs(difference.x), 2 * step * float(size) * 3) << size;
    }
  }
}

TEST(CubeMap, TapsWeighOne) {
  std::mt19937 random(5);
  for (int i = 0; i < 20000; ++i) {
    const CubeTaps taps = cube_taps(3, random_direction(random));
    float sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      sum += taps.weight[k];
      EXPECT_GE(taps.weight[k], 0);
      EXPECT_LT(taps.texel[k], 54U);
    }
    EXPECT_NEAR(sum, 1, 1e-6);
  }
}

}  // namespace
}  // namespace ivory
