// Cube maps made ready for one way of reading: the same light as by definition, and the memory that it takes.
#include "grid/cubemap/reader.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tools/stability/cube_builder.h"

namespace ivory {
namespace {

LocalizedCube room(int size, const Light& light) {
  return make_cube(size, V3f(1, 2, 3), box_around(V3d(-1, -0.5, -2), V3d(0.7, 1.5, 1)), light);
}

TEST(CubeReader, ReadsWhatEachMethodDefines) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  const LocalizedCube cube = room(4, [&](const V3f&) { return Rgb(unit(random), 1, 0); });
  for (const CubeMethod method : {CubeMethod::point, CubeMethod::polygon_paper, CubeMethod::polygon}) {
    const CubeReader reader = make_cube_reader(cube, method);
    for (int i = 0; i < 500; ++i) {
      const V3f p = cube.origin_m + random_unit(random) * (0.49F * unit(random));
      const V3f n = random_unit(random);
      const Rgb e = irradiance(reader, p, n);
      const Rgb slow = irradiance(cube, method, p, n);
      // Only polygons are summed otherwise: roundings of some hundred terms of up to pi.
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(e[c], slow[c], method == CubeMethod::polygon ? 2e-4F : 0.0F);
    }
  }
}

// An interpolated map of what is exactly pi L is pi L.
TEST(CubeReader, ConvolvedConstantRadianceIsPiL) {
  const LocalizedCube cube = room(2, [](const V3f&) { return Rgb(2, 0, 1e20F); });
  const CubeReader reader = make_cube_reader(cube, CubeMethod::convolved);
  std::mt19937 random(8);
  for (int i = 0; i < 1000; ++i) {
    const Rgb e = irradiance(reader, random_unit(random) * 9.0F, random_unit(random));
    EXPECT_NEAR(e.x / (2 * pi), 1, 1e-6F);  // the weights' rounding
    EXPECT_EQ(e.y, 0);
    EXPECT_NEAR(e.z / (1e20F * pi), 1, 1e-6F);
  }
}

// Interpolation errs by (texel width)^2/8 = 1/512 of E's slope where E is smooth, and most beside the cube's corners,
// where the mean of three texels stands for the missing fourth: 1/200. Where a small light meets the horizon it is half
// of half a texel's width times the kink's slope: 1/32.
TEST(CubeReader, ConvolvedMapIsTheConvolutionButForInterpolation) {
  std::mt19937 random(9);
  for (const int size : {1, 2, 4, 8, 16}) {
    const std::size_t lit = std::size_t(random()) % (6U * unsigned(size * size));
    for (const bool alone : {false, true}) {
      LocalizedCube cube = room(size, [](const V3f& w) { return Rgb(1 + 0.9F * w.x, 1 + 0.9F * w.y, 1); });
      if (alone) {
        for (std::size_t i = 0; i < cube.radiance.texels.size(); ++i)
          cube.radiance.texels[i] = i == lit ? Rgb(1, 1, 1) : Rgb(0, 0, 0);
      }
      const CubeReader reader = make_cube_reader(cube, CubeMethod::convolved);
      double largest = 0;
      for (const Rgb& e : reader.convolved.texels) largest = std::max(largest, double(e.x));
      double squares = 0;
      constexpr int count = 500;
      for (int i = 0; i < count; ++i) {
        const V3f n = random_unit(random);
        const V3f p = cube.origin_m + random_unit(random) * 5.0F;  // does not matter
        const double e = irradiance(reader, p, n).x;
        const double exact = irradiance(cube, CubeMethod::convolved, p, n).x;
        EXPECT_NEAR(e, exact, largest * (alone ? 1.0 / 32 : 1.0 / 200)) << size;
        squares += (e - exact) * (e - exact);
      }
      EXPECT_LT(std::sqrt(squares / count), largest / 400) << size << alone;
    }
  }
}

TEST(CubeReader, CountsTheBytesThatItReads) {
  const LocalizedCube cube = room(4, [](const V3f&) { return Rgb(1, 1, 1); });
  const std::size_t map = 6 * 16 * (3 + 4) * sizeof(float);  // radiance, distances of four corners
  EXPECT_EQ(make_cube_reader(cube, CubeMethod::convolved).bytes, 6U * 16 * 16 * 3 * sizeof(float));
  EXPECT_EQ(make_cube_reader(cube, CubeMethod::point).bytes, map);
  EXPECT_EQ(make_cube_reader(cube, CubeMethod::polygon_paper).bytes, map);
  // And a walk of 12 size^2 + 5 steps, each a point, a distance and a difference of radiance.
  EXPECT_EQ(make_cube_reader(cube, CubeMethod::polygon).bytes, map + (12 * 16 + 5) * 7 * sizeof(float));
}

}  // namespace
}  // namespace ivory
