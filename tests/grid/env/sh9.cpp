// The nine-coefficient polynomial: its matrices, bounds, windows, and what other engines make of it.
#include "grid/env/sh9.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/env/difmap.h"
#include "tests/grid/env/directional_light.h"

namespace ivory {
namespace {

TEST(Sh9, DirectionalLightGivesTheClosedForm) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const V3d w = random_direction(random);
    const V3d n = random_direction(random);
    const Sh9 sh = directional(w, V3d(1, 2, 10));
    const V3d e = irradiance_polynomial(sh, n);
    EXPECT_NEAR(e.x, three_bands(n.dot(w)), 1e-12);
    EXPECT_NEAR(e.z, 10 * three_bands(n.dot(w)), 1e-11);
    const Rgb shader = irradiance(to_float(sh9_matrices(sh)), V3f(n));
    EXPECT_NEAR(shader.y, std::max(0.0, 2 * three_bands(n.dot(w))), 2e-6);  // some twenty float roundings
  }
}

// Eq. 12's constants as printed there.
TEST(Sh9, MatrixIsThatOfThePaper) {
  for (std::size_t i = 0; i < 9; ++i) {
    Sh9 sh;
    sh.coefficients[i] = V3d(1, 0, 0);
    const auto m = sh9_matrices(sh)[0];
    for (std::size_t r = 0; r < 4; ++r)
      for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(m[4 * r + c], m[4 * c + r]);
    const std::array<std::array<double, 3>, 9> expected{{{15, 15, 0.886227},
                                                         {7, 13, 0.511664},
                                                         {11, 14, 0.511664},
                                                         {3, 12, 0.511664},
                                                         {1, 4, 0.429043},
                                                         {6, 9, 0.429043},
                                                         {10, 10, 0.743125},
                                                         {2, 8, 0.429043},
                                                         {0, 0, 0.429043}}};
    EXPECT_NEAR(m[std::size_t(expected[i][0])], expected[i][2], 2e-6) << i;  // rounded from rounded factors
    EXPECT_NEAR(m[std::size_t(expected[i][1])], expected[i][2], 2e-6) << i;  // rounded from rounded factors
    EXPECT_NEAR(m[15], i == 0 ? 0.886227 : (i == 6 ? -0.247708 : 0), 1e-6);
    EXPECT_NEAR(m[5], i == 8 ? -0.429043 : 0, 1e-6);
    EXPECT_EQ(sh9_matrices(sh)[1][std::size_t(expected[i][0])], 0);
  }
}

TEST(Sh9, LeastIrradianceIsTheLeastOfAllNormals) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 60; ++i) {
    Sh9 sh;
    for (std::size_t k = 0; k < 9; ++k) {
      // Every tenth has no linear part: the degenerate case of the minimisation.
      if (i % 10 == 0 && k >= 1 && k <= 3) continue;
      if (i % 10 == 5 && k >= 4) continue;
      sh.coefficients[k] = V3d(normal(random), normal(random), normal(random));
    }
    const V3d least = minimum_irradiance(sh);
    double sampled = 1e9;
    for (int face = 0; face < cube_faces; ++face)
      for (int row = 0; row < 64; ++row)
        for (int column = 0; column < 64; ++column)
          sampled = std::min(sampled, irradiance_polynomial(sh, V3d(cube_texel_direction(64, face, row, column))).y);
    EXPECT_LE(least.y, sampled + 1e-6);  // directions are rounded to floats
    // Nearest sample within 1/64 rad of the minimum, second derivatives below some 10: 10/64^2/2.
    EXPECT_NEAR(least.y, sampled, 2e-3) << i;
  }
  EXPECT_NEAR(minimum_irradiance(directional(V3d(0.6, 0, 0.8), V3d(1, 1, 1))).x, three_bands(-0.5333333333), 1e-9);
}

TEST(Sh9, WindowIsTheLeastThatLeavesNoNegativeLobe) {
  std::mt19937 random(3);
  for (int i = 0; i < 10; ++i) {
    const Sh9 sh = directional(random_direction(random), V3d(1, 1, 1));
    const Sh9Window window = least_window(sh);
    EXPECT_GE(minimum_irradiance(windowed(sh, window)).x, -1e-9);
    EXPECT_DOUBLE_EQ(windowed(sh, window).coefficients[0].x, sh.coefficients[0].x);
    // 1/4 + a x/2 + b 5/32 (3 x^2 - 1) touches zero, within [-1, 1], where (a/2)^2 = 4 (15/32 b) (1/4 - 5/32 b). The
    // change in mean square over x: (1 - a)^2 / 12 + (1 - b)^2 (5/32)^2 4/5. Its least, by brute force.
    double least = 1e9;
    Sh9Window expected;
    for (int k = 2600; k <= 10000; ++k) {
      const double b = k * 1e-4;
      const double a = std::min(1.0, 2 * std::sqrt(4 * 15.0 / 32 * b * (0.25 - 5.0 / 32 * b)));
      const double change = (1 - a) * (1 - a) / 12 + (1 - b) * (1 - b) * 25 / 1024 * 4 / 5;
      if (change < least) {
        least = change;
        expected = {a, b};
      }
    }
    EXPECT_NEAR(window.band1, expected.band1, 1e-3);
    EXPECT_NEAR(window.band2, expected.band2, 1e-3);
  }
  // Several lights: no neighbour of the answer is both good and nearer.
  for (int i = 0; i < 10; ++i) {
    Sh9 sh;
    for (int light = 0; light < 3; ++light) {
      const Sh9 one = directional(random_direction(random), V3d(1, 0.1 * light, 2));
      for (std::size_t k = 0; k < 9; ++k) sh.coefficients[k] += one.coefficients[k];
    }
    const Sh9Window window = least_window(sh);
    const V3d least = minimum_irradiance(windowed(sh, window));
    EXPECT_GE(std::min({least.x, least.y, least.z}), -1e-9);
    if (window.band1 < 1) {
      const V3d more = minimum_irradiance(windowed(sh, {window.band1 * 1.001, window.band2}));
      EXPECT_LT(std::min({more.x, more.y, more.z}), 0);
    }
  }
  Sh9 uniform;
  uniform.coefficients[0] = V3d(1, 1, 1);
  EXPECT_EQ(least_window(uniform).band1, 1);
  EXPECT_EQ(least_window(Sh9{}).band2, 1);
  EXPECT_NEAR(hann_window(4).band1, 0.5 + std::sqrt(0.125), 1e-12);
  EXPECT_NEAR(hann_window(4).band2, 0.5, 1e-12);
}

TEST(Sh9, ErrorOfOneDirectionalLightIsThePapersBound) {
  // Truth: the clamped cosine. Worst at the horizon: 1/4 - 5/32 = 9.4 % of the light.
  const V3d w = V3d(1, 2, 3).normalized();
  CubeMap truth{64, std::vector<Rgb>(6 * 64 * 64)};
  for (int face = 0; face < cube_faces; ++face)
    for (int row = 0; row < 64; ++row)
      for (int column = 0; column < 64; ++column) {
        const double x = V3d(cube_texel_direction(64, face, row, column)).dot(w);
        truth.texels[cube_index(64, face, row, column)] = Rgb(float(std::max(0.0, x)), 0, 0);
      }
  const Sh9 sh = directional(w, V3d(1, 0, 0));
  const Sh9Error error = sh9_error(sh, truth, V3d(1, 0, 0));
  // Nearest texel centre to the horizon within 1/64/2 rad, kernel's slope there 1/2.
  EXPECT_NEAR(error.maximum, 0.09375, 0.005);
  // Average of |max(0, x) - max(0, three_bands(x))| over the sphere: midpoint sum over x.
  double average = 0;
  for (int i = 0; i < 100000; ++i) {
    const double x = (i + 0.5) / 50000 - 1;
    average += std::abs(std::max(0.0, x) - std::max(0.0, three_bands(x))) / 100000;
  }
  EXPECT_NEAR(error.average, average, 1e-4);
  EXPECT_NEAR(error.average_of_mean_e(), 4 * average, 4e-4);
}

TEST(Sh9, TruncationKeepsLowerBands) {
  const Sh9 sh = directional(V3d(0.6, 0.8, 0), V3d(1, 1, 1));
  for (int order = 0; order <= 2; ++order) {
    const Sh9 cut = truncated(sh, order);
    for (std::size_t i = 0; i < 9; ++i)
      EXPECT_EQ(cut.coefficients[i].x, i < std::size_t((order + 1) * (order + 1)) ? sh.coefficients[i].x : 0);
  }
}

}  // namespace
}  // namespace ivory
