// Moments of radiance and the nine harmonics: every layout, every axis, against closed forms.
#include "grid/env/moments.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/env/cube_from_latlong.h"
#include "grid/env/sh9.h"
#include "tests/support/environment_pictures.h"

namespace ivory {
namespace {

constexpr double pi_d = 3.14159265358979323846;

RadianceMoments moments_of(EnvironmentLayout layout, const Picture& picture) {
  if (layout == EnvironmentLayout::latlong)
    return latlong_moments(picture.texels, picture.width, picture.height, 0, picture.height);
  if (layout == EnvironmentLayout::angular) return angular_moments({picture.width, picture.texels}, 0, picture.width);
  const CubeMap cube = cube_from_picture(layout, picture.texels, picture.width, picture.height);
  return cube_moments(cube, 0, cube.size);
}

// The harmonics of eq. 3, from the definition.
std::array<double, 9> harmonics(const V3d& w) {
  const double k = std::sqrt(15 / (4 * pi_d));
  return {std::sqrt(1 / (4 * pi_d)),
          std::sqrt(3 / (4 * pi_d)) * w.y,
          std::sqrt(3 / (4 * pi_d)) * w.z,
          std::sqrt(3 / (4 * pi_d)) * w.x,
          k * w.x * w.y,
          k * w.y * w.z,
          std::sqrt(5 / (16 * pi_d)) * (3 * w.z * w.z - 1),
          k * w.x * w.z,
          k / 2 * (w.x * w.x - w.y * w.y)};
}

TEST(RadianceMoments, UniformLightInEveryLayout) {
  for (const EnvironmentLayout layout : all_layouts) {
    for (const int detail : {1, 2, 5, 32}) {
      const Picture picture = make_picture(layout, detail, [](const V3d&) { return Rgb(2, 3, 0.25F); });
      const Sh9 sh = sh9_from_moments(moments_of(layout, picture));
      // L00 = 2 sqrt(pi) L. Lat-long and cubes are exact; the angular map's rim is (grid/env/angular_map.h).
      const double tolerance = layout != EnvironmentLayout::angular ? 1e-9 : (detail < 4 ? 2e-2 : 1e-4);
      EXPECT_NEAR(sh.coefficients[0].x / (2 * 2 * std::sqrt(pi_d)), 1, tolerance) << name_of(layout) << detail;
      EXPECT_NEAR(sh.coefficients[0].z / (0.25 * 2 * std::sqrt(pi_d)), 1, tolerance) << name_of(layout) << detail;
      for (std::size_t i = 1; i < 9; ++i)
        EXPECT_NEAR(sh.coefficients[i].y / sh.coefficients[0].y, 0, tolerance) << name_of(layout) << detail << ' ' << i;
    }
  }
}

// L = 1 + sum a_i Y_i, positive, a different set for each colour: the coefficients come back.
TEST(RadianceMoments, KnownCoefficientsComeBackInEveryLayoutAndAxis) {
  const std::array<std::array<double, 9>, 3> a{{{5, 0.5, -0.3, 0.7, 0.2, -0.4, 0.6, 0.1, -0.5},
                                                {4, -0.2, 0.8, 0.1, -0.6, 0.3, 0.2, -0.7, 0.4},
                                                {6, 0.9, 0.4, -0.5, 0.3, 0.7, -0.8, 0.2, 0.6}}};
  for (const EnvironmentLayout layout : all_layouts) {
    const Picture picture = make_picture(layout, 96, [&](const V3d& w) {
      const auto y = harmonics(w);
      Rgb l(0, 0, 0);
      for (unsigned c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < 9; ++i) l[c] += float(a[c][i] * y[i]);
      return l;
    });
    const Sh9 sh = sh9_from_moments(moments_of(layout, picture));
    for (unsigned c = 0; c < 3; ++c) {
      // A texel of 1/96 of a right angle, piecewise constant: the mean of a harmonic over it deviates from the
      // harmonic weighted exactly by h^2/24 l(l+1) ~ 7e-5 of the coefficient at l = 2; relative to L00.
      for (std::size_t i = 0; i < 9; ++i)
        EXPECT_NEAR(sh.coefficients[i][int(c)] / a[c][0], a[c][i] / a[c][0], 1e-4) << name_of(layout) << i << c;
    }
  }
}

// Row ranges add up, in any division, for widths that are no multiple of the loop's stride.
TEST(RadianceMoments, RangesAddUpToDirectSums) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value;
  for (const auto& [width, height] : {std::pair{2, 1}, {7, 5}, {254, 127}, {520, 20}, {1030, 9}, {2056, 3}}) {
    std::vector<Rgb> texels(std::size_t(width * height));
    for (Rgb& texel : texels) texel = Rgb(value(random), value(random), value(random));
    RadianceMoments parts;
    for (int row = 0; row < height; row += 2)
      parts += latlong_moments(texels, width, height, row, std::min(row + 2, height));
    // The slow twin: 12 x 12 midpoints a texel. Error of the midpoint rule: (h/12)^2/24, h the texel's angle.
    RadianceMoments slow;
    constexpr int n = 12;
    for (int row = 0; row < height; ++row) {
      for (int column = 0; column < width; ++column) {
        const V3d l(texels[std::size_t(row * width + column)]);
        for (int k = 0; k < n * n; ++k) {
          const double p = (row + (k / n + 0.5) / n) * pi_d / height;
          const double q = (column + (k % n + 0.5) / n) * 2 * pi_d / width - pi_d;
          const V3d w(-std::sin(p) * std::sin(q), std::cos(p), std::sin(p) * std::cos(q));
          const double weight = std::sin(p) * pi_d / height * 2 * pi_d / width / (n * n);
          slow.total += l * weight;
          for (unsigned i = 0; i < 3; ++i) slow.first[i] += l * (w[int(i)] * weight);
          slow.second[0] += l * (w.x * w.x * weight);
          slow.second[1] += l * (w.y * w.y * weight);
          slow.second[2] += l * (w.z * w.z * weight);
          slow.second[3] += l * (w.x * w.y * weight);
          slow.second[4] += l * (w.y * w.z * weight);
          slow.second[5] += l * (w.x * w.z * weight);
        }
      }
    }
    const double h = pi_d / std::min(height, width / 2) / n;
    const double tolerance = slow.total.x * (h * h / 2 + 1e-12);
    EXPECT_NEAR(parts.total.x, slow.total.x, tolerance) << width;
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(parts.first[i].y, slow.first[i].y, tolerance) << width << ' ' << i;
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(parts.second[i].z, slow.second[i].z, tolerance) << width << ' ' << i;
    // w.w = 1.
    EXPECT_NEAR(parts.second[0].x + parts.second[1].x + parts.second[2].x, parts.total.x, parts.total.x * 1e-13);
  }
}

TEST(RadianceMoments, TexelsShareOutTheSphere) {
  for (const int n : {1, 3, 16, 100}) {
    double solid_angle = 0;
    V3d first(0, 0, 0);
    const LatLongTexels latlong(2 * n, n);
    for (int row = 0; row < n; ++row) {
      for (int column = 0; column < 2 * n; ++column) {
        const TexelMoments m = latlong(row, column);
        solid_angle += m.solid_angle;
        first += m.first;
      }
    }
    EXPECT_NEAR(solid_angle, 4 * pi_d, 1e-11);
    EXPECT_LT(first.length(), 1e-11);
    double face = 0;
    for (int row = 0; row < n; ++row) {
      for (int column = 0; column < n; ++column) {
        const TexelMoments m = cube_texel_moments(n, row, column);
        EXPECT_NEAR(m.solid_angle / cube_texel_solid_angle(n, row, column), 1, 1e-9);
        face += m.solid_angle;
      }
    }
    EXPECT_NEAR(6 * face, 4 * pi_d, 1e-9);
  }
  for (const auto& [size, tolerance] : {std::pair{16, 1e-4}, {128, 1e-6}, {257, 1e-6}}) {
    double disc = 0;
    for (int row = 0; row < size; ++row)
      for (int column = 0; column < size; ++column) disc += angular_texel_moments(size, row, column).solid_angle;
    EXPECT_NEAR(disc / (4 * pi_d), 1, tolerance) << size;
  }
}

TEST(AngularMap, TexelsOfDirections) {
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 10000; ++i) {
    const V3f w = V3f(normal(random), normal(random), normal(random)).normalized();
    const std::size_t texel = angular_texel(64, w);
    const auto direction =
        picture_direction(EnvironmentLayout::angular, 64, 64, double(texel % 64) + 0.5, double(texel / 64) + 0.5);
    // A rim texel's centre may lie outside the disc.
    if (!direction) continue;
    const double across = std::acos(std::min(1.0, direction->dot(V3d(w))));
    // Half a diagonal: pi sqrt(2)/64, as steps across the radius turn by no more than those along it.
    EXPECT_LT(across, pi_d * std::sqrt(2.0) / 64 + 1e-6);
  }
  // The poles of the layout are texels, not crashes.
  EXPECT_LT(angular_texel(64, {0, 0, 1}), 64U * 64U);
  EXPECT_LT(angular_texel(64, {0, 0, -1}), 64U * 64U);
}

TEST(EnvironmentLayout, NamesShapesAndAspects) {
  for (const EnvironmentLayout layout : all_layouts) {
    EXPECT_EQ(from_name<EnvironmentLayout>(name_of(layout)), layout);
    const Picture picture = make_picture(layout, 4, [](const V3d&) { return Rgb(1, 1, 1); });
    EXPECT_EQ(layout_of_aspect(picture.width, picture.height), layout);
    for (const EnvironmentLayout other : all_layouts)
      EXPECT_EQ(fits(other, picture.width, picture.height), other == layout);
  }
  EXPECT_FALSE(layout_of_aspect(5, 4));
  EXPECT_FALSE(layout_of_aspect(0, 0));
  EXPECT_THROW(from_name<EnvironmentLayout>("mirror_ball"), ParameterError);
}

}  // namespace
}  // namespace ivory
