// Points that stand for emissive surfaces, against the surfaces' power and the light that they give.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/lights_check.h"

namespace ivory {
namespace {

V3d power_of(const std::vector<EmitterPoint>& points) {
  V3d sum(0, 0, 0);
  for (const EmitterPoint& p : points) sum += V3d(p.radiance_nits * (pi * p.area_m2));
  return sum;
}

// One lamp: points are spread evenly over it, and every one stands for as much of it.
TEST(EmitterPoints, HoldTheLampsPowerAndLight) {
  for (const bool both : {false, true}) {
    const LitScene lit = in_black_box(lamp_scene(both));
    const std::vector<EmitterPoint> points = lit.lights.emitter_points(4096, 1);
    ASSERT_EQ(points.size(), 4096U);
    const V3d power = power_of(points);
    // Both triangles of the quad shine alike, so that nothing is left to chance.
    for (unsigned c = 0; c < 3; ++c)
      EXPECT_NEAR(power[c], double(lit.lights.total_power_lm()[int(c)]), 1e-4 * power[c]) << both;
    // sum of L A cos cos' / r^2, of points below the lamp: low-discrepancy points leave far less than the 1.6 % that
    // 4,096 independent ones would.
    for (const V3f& p : {V3f(0.5F, 0, 1.5F), V3f(-1, 0.3F, 0.2F)}) {
      double e = 0;
      int above = 0;
      for (const EmitterPoint& point : points) {
        const V3f d = point.p - p;
        const float r2 = d.dot(d);
        const float cos2 = std::max(0.0F, d.y) * std::max(0.0F, -d.dot(point.n)) / r2;
        e += double(point.radiance_nits.x * point.area_m2 * cos2 / r2);
        above += int(point.n.y > 0);
      }
      const Accumulator truth = irradiance_samples(lit.lights, p, V3f(0, 1, 0), 400000);
      EXPECT_NEAR(e, truth.mean(), 4 * truth.standard_error() + 5e-3 * truth.mean()) << both << p;
      EXPECT_NEAR(above, both ? 2048 : 0, both ? 4 * 32 : 0);
    }
  }
}

// A dim lamp beside a bright one gets points enough, and the sum is still that of both.
TEST(EmitterPoints, DimLampsAreNotStarved) {
  Scene scene = lamp_scene(false);
  const int dim = add_lambert(scene, Rgb(0, 0, 0), Rgb(1e-3F, 1e-3F, 1e-3F));
  add_mesh(scene, make_quad({5, 2, 0}, {1, 0, 0}, {0, 0, 1}, dim));
  const LitScene lit = in_black_box(std::move(scene));
  const std::vector<EmitterPoint> points = lit.lights.emitter_points(2048, 3);
  double of_dim = 0;
  int count = 0;
  for (const EmitterPoint& p : points) {
    if (p.instance != 1) continue;
    ++count;
    of_dim += double(p.area_m2);
  }
  EXPECT_GT(count, 2048 / 5);  // a quarter: half of the picks are even, and there are two instances
  // Half of its triangles' picks and of the table's rounding: binomial, 4 standard errors of 500 points.
  EXPECT_NEAR(of_dim, 1, 0.18);
  EXPECT_TRUE(in_black_box(Scene()).lights.emitter_points(100, 1).empty());
}

}  // namespace
}  // namespace ivory
