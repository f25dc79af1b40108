// Irradiance through the hierarchy against closed forms and a sum over all texels.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "grid/env/irradiance/tree.h"
#include "grid/env/moments.h"

namespace ivory {
namespace {

constexpr double pi_d = 3.14159265358979323846;

V3d random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return V3d(normal(random), normal(random), normal(random)).normalized();
}

IrradianceTree latlong_tree(const std::vector<Rgb>& map, int width, int height, int size) {
  IrradianceTree tree(size);
  const LatLongTexels texels(width, height);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const TexelMoments m = texels(row, column);
      tree.add(map[std::size_t(row * width + column)], m.solid_angle, m.first, pi_d / height);
    }
  }
  tree.finish();
  return tree;
}

// The slow twin: every texel, those near the horizon in 16 x 16 parts.
double brute_force(const std::vector<Rgb>& map, int width, int height, const V3d& n) {
  const LatLongTexels texels(width, height);
  const LatLongTexels parts(16 * width, 16 * height);
  double sum = 0;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const TexelMoments m = texels(row, column);
      const double l = map[std::size_t(row * width + column)].x;
      const double above = n.dot(m.first);
      if (std::abs(above) > m.solid_angle * pi_d / height) {
        sum += above > 0 ? l * above : 0;
        continue;
      }
      for (int k = 0; k < 256; ++k)
        sum += l * std::max(0.0, n.dot(parts(16 * row + k / 16, 16 * column + k % 16).first));
    }
  }
  return sum;
}

TEST(IrradianceTree, UniformLight) {
  const std::vector<Rgb> map(128 * 64, Rgb(2, 1, 0));
  const IrradianceTree tree = latlong_tree(map, 128, 64, 32);
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const auto estimate = tree.irradiance(random_direction(random));
    // The horizon runs through cells 1/32 wide: their light (1/32 of it all) times a tenth of their width.
    EXPECT_NEAR(estimate.e.x, 2 * pi_d, 1e-3 * 2 * pi_d);
    EXPECT_NEAR(estimate.e.x, 2 * pi_d, estimate.error.x + 1e-9);
    EXPECT_EQ(estimate.e.z, 0);
  }
  EXPECT_NEAR(tree.total().x, 8 * pi_d, 1e-9);
}

TEST(IrradianceTree, StaysWithinItsBoundOfTheFullSum) {
  std::mt19937 random(2);
  // A rough night sky with some suns; the last map has nothing but one texel.
  for (const int suns : {0, 3, -1}) {
    constexpr int width = 256;
    constexpr int height = 128;
    std::exponential_distribution<float> value;
    std::vector<Rgb> map(width * height, Rgb(0, 0, 0));
    if (suns >= 0) {
      for (Rgb& texel : map) texel = Rgb(value(random), 0, 0);
    }
    for (int i = 0; i < std::abs(suns); ++i) map[random() % map.size()].x += 1e5F;
    const IrradianceTree tree = latlong_tree(map, width, height, 64);
    double worst = 0;
    for (int i = 0; i < 60; ++i) {
      const V3d n = random_direction(random);
      const double truth = brute_force(map, width, height, n);
      for (const double tolerance : {1e-7, 1e-6, 1e-3}) {
        const auto estimate = tree.irradiance(n, tolerance);
        // The twin's own error: of a sun's 16 x 16 parts the horizon cuts 16, each off by a quarter of its width of
        // 1.5e-3 at most.
        EXPECT_LE(std::abs(estimate.e.x - truth), estimate.error.x + 2.4e-5 * tree.total().x)
            << suns << ' ' << tolerance;
        if (tolerance < 1e-5) worst = std::max(worst, std::abs(estimate.e.x - truth) / tree.total().x);
      }
    }
    // Cells 1/64 wide, where the horizon cuts them: a quarter of their half-width for one sun, averaged out for
    // many texels.
    EXPECT_LT(worst, suns == 0 ? 2e-4 : 5e-3);
  }
}

TEST(IrradianceTree, LightAboveAndBelowIsExact) {
  // One texel around +Y; normals within a right angle of it less its extent see n.V.
  constexpr int width = 64;
  constexpr int height = 32;
  std::vector<Rgb> map(width * height, Rgb(0, 0, 0));
  for (int column = 0; column < width; ++column) map[std::size_t(column)] = Rgb(5, 5, 5);
  const IrradianceTree tree = latlong_tree(map, width, height, 16);
  const double cap = 1 - std::cos(pi_d / height);
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i) {
    const V3d n = random_direction(random);
    // Cells 1/16 wide reach at most 0.1 + pi/32 from the pole.
    if (std::abs(n.y) < 0.35) continue;
    const auto estimate = tree.irradiance(n);
    // integral of w over a cap: pi sin^2(half-angle) along its axis.
    const double expected = n.y > 0 ? 5 * pi_d * (1 - (1 - cap) * (1 - cap)) * n.y : 0;
    EXPECT_NEAR(estimate.e.x, expected, 1e-12);
    EXPECT_EQ(estimate.error.x, 0);
  }
}

TEST(IrradianceTree, NoLightIsNoError) {
  IrradianceTree tree(4);
  tree.finish();
  EXPECT_EQ(tree.irradiance(V3d(0, 1, 0)).e, V3d(0, 0, 0));
}

}  // namespace
}  // namespace ivory
