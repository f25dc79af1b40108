// Irradiance summed over an environment map's texels: closed forms, quadrature, and the tree's bounds.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "grid/env/environment_image.h"
#include "grid/env/irradiance.h"
#include "grid/env/irradiance/sum.h"
#include "grid/env/latlong_map.h"

namespace ivory {
namespace {

constexpr double pi_d = 3.14159265358979323846;

EnvironmentImage image_of(EnvironmentMap map) { return {EnvironmentLayout::latlong, std::move(map)}; }

std::vector<V3f> some_normals(int count) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::vector<V3f> n{V3f(0, 1, 0), V3f(0, -1, 0), V3f(1, 0, 0), V3f(0, 0, -1)};
  while (int(n.size()) < count) n.push_back(V3f(normal(random), normal(random), normal(random)).normalized());
  return n;
}

TEST(IrradianceSum, ConstantMapsArePiL) {
  const Rgb l(1, 0, 3e4F);
  const std::vector<V3f> normals = some_normals(40);
  const std::vector<EnvironmentImage> images{
      image_of({2, 1, std::vector<Rgb>(2, l)}),
      image_of({64, 32, std::vector<Rgb>(64 * 32, l)}),
      {EnvironmentLayout::cube, CubeMap{8, std::vector<Rgb>(6 * 8 * 8, l)}},
      {EnvironmentLayout::angular, AngularMap{32, std::vector<Rgb>(32 * 32, l)}}};
  for (const EnvironmentImage& image : images) {
    const IrradianceSums sums = sum_irradiance(image, normals);
    ASSERT_EQ(sums.e.size(), normals.size());
    // An angular map's solid angles sum to 4 pi within 1e-4.
    const double rule = image.layout == EnvironmentLayout::angular ? 3e-4 : 1e-6;
    for (const V3d& e : sums.e) {
      EXPECT_NEAR(e.x, pi_d, sums.error_bound.x + rule);
      EXPECT_EQ(e.y, 0);
      EXPECT_NEAR(e.z / 3e4, pi_d, sums.error_bound.x + rule);
    }
    // Parts of a texel are s wide: those that the horizon cuts hold s/2 of E and are off by s/2 of that, with s up to
    // 3/64 for two texels and 3/1000 for the others, and half as much again for the room in reach().
    const bool coarse =
        std::holds_alternative<EnvironmentMap>(image.map) && std::get<EnvironmentMap>(image.map).height == 1;
    EXPECT_LT(sums.error_bound.x, coarse ? 0.05 : 1e-3);
  }
}

// A texel alone, by 400 x 400 points of it: the midpoint rule over a texel of 0.05 rad is exact to 1e-6 of its flux,
// and to 1e-4 where the horizon cuts it.
TEST(IrradianceSum, OneTexelIsItsIntegral) {
  constexpr int width = 128;
  constexpr int height = 64;
  for (const int row : {0, 20, 63}) {
    EnvironmentMap map{width, height, std::vector<Rgb>(std::size_t(width * height), Rgb(0, 0, 0))};
    constexpr int column = 37;
    map.radiance[std::size_t(row * width + column)] = Rgb(7, 0, 1);
    // Texels are constant: eval() tells which way the picture turns, once for each point.
    std::vector<V3d> w;
    std::vector<double> solid_angle;
    double flux = 0;
    constexpr int n = 400;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const double theta = pi_d * (row + (i + 0.5) / n) / height;
        const double phi = 2 * pi_d * (column + (j + 0.5) / n) / width;
        // +Z in the middle, +X to its left.
        w.emplace_back(std::sin(theta) * std::sin(pi_d - phi), std::cos(theta), std::sin(theta) * std::cos(pi_d - phi));
        solid_angle.push_back(std::sin(theta) * (pi_d / height / n) * (2 * pi_d / width / n));
        flux += solid_angle.back();
      }
    }
    ASSERT_EQ(eval(map, V3f(w[w.size() / 2 + n / 2])), Rgb(7, 0, 1));
    std::vector<V3f> normals = some_normals(30);
    // Horizons through the texel.
    const V3f center(w[w.size() / 2 + n / 2]);
    for (int i = 0; i < 20; ++i) normals.push_back(normals[std::size_t(i)].cross(center).normalized());
    const IrradianceSums sums = sum_irradiance(image_of(map), normals);
    EXPECT_LT(sums.error_bound.x, 7 * flux * 2e-3);  // 1/64 of half a texel's 0.05 rad at most, with room for reach()
    for (std::size_t k = 0; k < normals.size(); ++k) {
      double e = 0;
      for (std::size_t i = 0; i < w.size(); ++i) e += std::max(0.0, V3d(normals[k]).dot(w[i])) * solid_angle[i];
      EXPECT_NEAR(sums.e[k].x, 7 * e, sums.error_bound.x + 7e-6 * flux) << row << " " << k;
      EXPECT_EQ(sums.e[k].y, 0);
    }
  }
}

// Within the tree's own bounds, which are wider by far.
TEST(IrradianceSum, AgreesWithTheTreeWithinBothBounds) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(0, 1);
  EnvironmentMap map{128, 64, {}};
  for (int i = 0; i < 128 * 64; ++i) map.radiance.emplace_back(unit(random), std::pow(unit(random), 8.0F), 1.0F);
  map.radiance[3000] = Rgb(5e3F, 5e3F, 5e3F);
  const EnvironmentImage image = image_of(std::move(map));
  const IrradianceTree tree = make_irradiance_tree(image);
  const std::vector<V3f> normals = some_normals(300);
  const IrradianceSums sums = sum_irradiance(image, normals);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const IrradianceTree::Estimate estimate = tree.irradiance(V3d(normals[i]));
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(sums.e[i][c], estimate.e[c], estimate.error[c] + sums.error_bound[c] + 1e-9 * tree.total()[c]) << i;
  }
}

}  // namespace
}  // namespace ivory
