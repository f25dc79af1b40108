// Lat-long to cube: energy, constants, and a slow twin that samples the map densely.
#include "grid/env/cube_from_latlong.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace ivory {
namespace {

constexpr double pi_d = 3.14159265358979323846;

std::vector<Rgb> random_latlong(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::exponential_distribution<float> value;
  std::vector<Rgb> map(std::size_t(width) * std::size_t(height));
  for (Rgb& texel : map) texel = Rgb(value(random), value(random), value(random));
  return map;
}

double row_solid_angle(int width, int height, int row) {
  return 2 * pi_d / width * (std::cos(row * pi_d / height) - std::cos((row + 1) * pi_d / height));
}

V3d latlong_flux(const std::vector<Rgb>& map, int width, int height) {
  V3d flux(0, 0, 0);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      flux += V3d(map[std::size_t(row * width + column)]) * row_solid_angle(width, height, row);
  return flux;
}

V3d cube_flux(const CubeMap& cube) {
  V3d flux(0, 0, 0);
  for (int face = 0; face < cube_faces; ++face)
    for (int row = 0; row < cube.size; ++row)
      for (int column = 0; column < cube.size; ++column)
        flux +=
            V3d(cube.texels[cube_index(cube.size, face, row, column)]) * cube_texel_solid_angle(cube.size, row, column);
  return flux;
}

// The renderer's look-up, in double.
Rgb latlong_at(const std::vector<Rgb>& map, int width, int height, const V3d& w) {
  const double u = 0.5 + std::atan2(-w.x, w.z) / (2 * pi_d);
  const double v = std::atan2(std::hypot(w.x, w.z), w.y) / pi_d;
  const int column = std::clamp(int(u * width), 0, width - 1);
  const int row = std::clamp(int(v * height), 0, height - 1);
  return map[std::size_t(row * width + column)];
}

struct Shape {
  int width, height, size;
};
// Odd and even, finer and coarser than the cube, one texel only, columns that face borders cut.
constexpr Shape shapes[] = {{64, 32, 8}, {2, 1, 1}, {2, 1, 5}, {7, 5, 3}, {30, 15, 4}, {16, 8, 33}, {200, 100, 5}};

TEST(CubeFromLatLong, KeepsTheFlux) {
  for (const auto& [width, height, size] : shapes) {
    const auto map = random_latlong(width, height, 1);
    const V3d before = latlong_flux(map, width, height);
    const V3d after = cube_flux(cube_from_latlong(map, width, height, size));
    // The texels are kept as floats: independent roundings of 3e-8.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(after[c] / before[c], 1, 1e-7) << width << ' ' << size;
  }
}

TEST(CubeFromLatLong, KeepsConstants) {
  for (const auto& [width, height, size] : shapes) {
    const std::vector<Rgb> map(std::size_t(width * height), Rgb(3, 0.1F, 1e6F));
    for (const Rgb& texel : cube_from_latlong(map, width, height, size).texels) {
      EXPECT_FLOAT_EQ(texel.x, 3);
      EXPECT_FLOAT_EQ(texel.y, 0.1F);
      EXPECT_FLOAT_EQ(texel.z, 1e6F);
    }
  }
}

TEST(CubeFromLatLong, EqualsDenseSampling) {
  for (const auto& [width, height, size] : shapes) {
    const auto map = random_latlong(width, height, 2);
    const CubeMap cube = cube_from_latlong(map, width, height, size);
    // n x n midpoints, an odd number that hits no map edge in a pattern: the area of a straight-edged part of a
    // texel is off by less than the strata its border crosses, 2 n of n^2 times the random half, ~ 1/n for each
    // border in turn; 4 borders, values up to about 7.
    const int n = size > 16 ? 41 : 151;
    for (int face = 0; face < cube_faces; ++face) {
      for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) {
          V3d sum(0, 0, 0);
          double weights = 0;
          for (int j = 0; j < n; ++j) {
            for (int i = 0; i < n; ++i) {
              const double s = cube_edge(size, column) + 2.0 / size * (i + 0.5) / n;
              const double t = cube_edge(size, row) + 2.0 / size * (j + 0.5) / n;
              const double weight = std::pow(1 + s * s + t * t, -1.5);
              sum += V3d(latlong_at(map, width, height, cube_point(face, s, t))) * weight;
              weights += weight;
            }
          }
          const Rgb texel = cube.texels[cube_index(size, face, row, column)];
          EXPECT_NEAR(texel.x, sum.x / weights, 4.0 / n) << width << ' ' << size << ' ' << face << row << column;
        }
      }
    }
  }
}

// A light of a single texel: nothing leaks elsewhere, nothing is negative, all of it arrives.
TEST(CubeFromLatLong, OneTexelStaysInItsPlace) {
  constexpr int width = 128;
  constexpr int height = 64;
  for (const int row : {0, 1, 17, 32, 50, 63}) {
    for (const int column : {0, 15, 16, 47, 100, 127}) {
      std::vector<Rgb> map(std::size_t(width * height), Rgb(0, 0, 0));
      map[std::size_t(row * width + column)] = Rgb(1e5F, 0, 0);
      const CubeMap cube = cube_from_latlong(map, width, height, 16);
      const double theta = (row + 0.5) * pi_d / height;
      const double phi = (column + 0.5) * 2 * pi_d / width - pi_d;
      const V3d centre(-std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
      double flux = 0;
      for (int face = 0; face < cube_faces; ++face) {
        for (int r = 0; r < 16; ++r) {
          for (int c = 0; c < 16; ++c) {
            const double here = cube.texels[cube_index(16, face, r, c)].x * cube_texel_solid_angle(16, r, c);
            flux += here;
            EXPECT_GE(here, 0);
            // Half diagonals: of the map's texel at most pi/64/sqrt(2) = 0.035, of the cube's 1/16 sqrt(2) = 0.088.
            if (std::acos(V3d(cube_texel_direction(16, face, r, c)).dot(centre)) > 0.035 + 0.09) {
              EXPECT_LT(here, 1e-13 * 1e5) << face << ' ' << r << ' ' << c;
            }
          }
        }
      }
      EXPECT_NEAR(flux / (1e5 * row_solid_angle(width, height, row)), 1, 1e-6);
    }
  }
}

}  // namespace
}  // namespace ivory
