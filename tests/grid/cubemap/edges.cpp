// Cube maps summed edge by edge against the sum texel by texel, and against what only edges hold exactly.
#include "grid/cubemap/edges.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tools/stability/cube_builder.h"

namespace ivory {
namespace {

constexpr int sizes[] = {1, 2, 3, 4, 8};

// A shell that folds over itself, with holes to the sky where `endless`.
LocalizedCube folded_cube(int size, bool endless, double key, const Light& light) {
  return make_cube(
      size, V3f(1, 2, 3),
      [=](const V3d& w) {
        const double u = std::abs(std::sin(12.9898 * w.x + 78.233 * w.y + 37.719 * w.z + key));
        return endless && u < 0.4 ? 0.0F : float(0.3 + u);
      },
      light);
}

// Any receiver: also in the planes of edges, at the origin, along axes, on the shell, far out through holes.
struct Receiver {
  V3f offset, n;
};
Receiver random_receiver(std::mt19937& random, int i) {
  std::uniform_real_distribution<float> unit(0, 1);
  Receiver r{random_unit(random) * (i % 5 == 0 ? 0.0F : 2 * unit(random)), random_unit(random)};
  if (i % 3 == 0) r.offset[i % 4 % 3] = 0;
  if (i % 11 == 0) r.offset *= 1000.0F;
  if (i % 7 == 0) {
    r.n = V3f(0, 0, 0);
    r.n[i % 3] = i % 2 == 0 ? 1.0F : -1.0F;
  }
  return r;
}

TEST(CubeEdges, WalkHoldsEachEdgeOnceAndTheJumpsCancel) {
  for (const int size : sizes) {
    const LocalizedCube cube = folded_cube(size, false, 1, [](const V3f& w) { return Rgb(2 + w.x, 0, 1); });
    const CubeEdges edges = make_cube_edges(cube);
    ASSERT_EQ(edges.steps(), std::size_t(12 * size * size + 5));
    EXPECT_EQ(edges.jump[0], Rgb(0, 0, 0));
    double length = 0;
    for (std::size_t i = 1; i < edges.steps(); ++i) {
      EXPECT_EQ(edges.jump[i].z, 0);  // nothing between equal texels
      const V3f step(edges.q_x[i] - edges.q_x[i - 1], edges.q_y[i] - edges.q_y[i - 1], edges.q_z[i] - edges.q_z[i - 1]);
      // An edge is as long as a texel; the four added ones go from corner to corner.
      if (std::abs(step.length() - 2.0F / float(size)) < 1e-5F) length += double(step.length());
    }
    EXPECT_GE(length, 24.0 * size - 1e-3) << size;
  }
}

TEST(CubeEdges, AgreeWithTexelByTexel) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const int size : sizes) {
    for (int k = 0; k < 40; ++k) {
      const Light light = [&](const V3f&) { return Rgb(unit(random), 100 * std::pow(unit(random), 4.0F), 1); };
      const LocalizedCube cube =
          k % 2 == 0 ? make_cube(size, V3f(1, 2, 3), box_around(V3d(-1, -0.5, -2), V3d(0.7, 1.5, 1)), light)
                     : folded_cube(size, k % 4 == 1, 1000 * double(unit(random)), light);
      const CubeEdges edges = make_cube_edges(cube);
      for (int i = 0; i < 250; ++i) {
        const Receiver r = random_receiver(random, i);
        if (r.offset.length() > 5) continue;  // where texel by texel loses its digits
        const V3f p = cube.origin_m + r.offset;
        const Rgb slow = irradiance(cube, CubeMethod::polygon, p, r.n);
        const Rgb fast = polygon_irradiance(cube, edges, p, r.n);
        for (int c = 0; c < 3; ++c) {
          // Roundings of some hundred terms of up to pi of the brightest texel; near the shell directions are a
          // thousandth of positions.
          ASSERT_NEAR(fast[c], slow[c], 2e-4F * pi * edges.brightest[c]) << size << " " << k << " " << r.offset << r.n;
        }
      }
    }
  }
}

// Texels that are alike have no jumps: what is left is exact, wherever the point lies.
TEST(CubeEdges, ConstantRadianceGivesPiToTheLastBit) {
  std::mt19937 random(6);
  for (const int size : sizes) {
    const LocalizedCube cube = folded_cube(size, true, 3, [](const V3f&) { return Rgb(2, 0, 1e20F); });
    const CubeEdges edges = make_cube_edges(cube);
    for (int i = 0; i < 2000; ++i) {
      const Receiver r = random_receiver(random, i);
      EXPECT_EQ(polygon_irradiance(cube, edges, cube.origin_m + r.offset, r.n), Rgb(2, 0, 1e20F) * pi);
    }
    const V3f nowhere(std::numeric_limits<float>::quiet_NaN(), 0, 0);
    EXPECT_EQ(polygon_irradiance(cube, edges, nowhere, V3f(0, 1, 0)), Rgb(2, 0, 1e20F) * pi);
  }
}

// Far out through a hole and in the plane of its edge, a part of a texel away the shell may lie behind the receiver.
TEST(CubeEdges, AgreeInThePlanesOfEdgesFarOutThroughHoles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  const Light light = [&](const V3f&) { return Rgb(unit(random), 100 * std::pow(unit(random), 4.0F), 1); };
  int tried = 0;
  for (const int size : {2, 4, 8}) {
    for (int k = 0; k < 20; ++k) {
      const LocalizedCube cube = folded_cube(size, true, 1000 * double(unit(random)), light);
      const CubeEdges edges = make_cube_edges(cube);
      for (int i = 0; i < 300; ++i) {
        V3f offset = random_unit(random);
        offset[i % 3] = 0;
        offset *= std::pow(10.0F, 1 + 4 * unit(random));
        if (inside_shell(cube, offset) != offset) continue;
        ++tried;
        const V3f n = random_unit(random);
        const Rgb slow = irradiance(cube, CubeMethod::polygon, cube.origin_m + offset, n);
        const Rgb fast = polygon_irradiance(cube, edges, cube.origin_m + offset, n);
        // Texel by texel, outlines of angles near pi lose three digits.
        for (int c = 0; c < 3; ++c) {
          ASSERT_NEAR(fast[c], slow[c], 1e-3F * pi * edges.brightest[c]) << size << " " << k << " " << offset << n;
        }
      }
    }
  }
  EXPECT_GT(tried, 1000);
}

// From far out the shell's finite part is a point: the sky's texels alone are left, which p does not move.
TEST(CubeEdges, FarOutOnlyTheSkyIsLeft) {
  const LocalizedCube cube = make_cube(
      4, V3f(0, 0, 0), [](const V3d& w) { return w.y > 0.5 ? 0.0F : float(std::max(0.2, 0.5 - w.y)); },
      [](const V3f& w) { return w.y > 0.8F ? Rgb(3, 3, 3) : Rgb(1, 1, 1); });
  const CubeEdges edges = make_cube_edges(cube);
  const Rgb far = polygon_irradiance(cube, edges, V3f(0, 1e5F, 0), V3f(0, 1, 0));
  const Rgb farther = polygon_irradiance(cube, edges, V3f(100, 1e7F, 100), V3f(0, 1, 0));
  EXPECT_GT(far.x, 1.2F * pi);
  EXPECT_NEAR(far.x / farther.x, 1, 1e-3F);
}

}  // namespace
}  // namespace ivory
