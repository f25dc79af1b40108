// Environments turned about +Y, and what is read of them.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "grid/base/placement.h"
#include "grid/env/turned_map.h"
#include "grid/fiv/set.h"

namespace ivory {
namespace {

EnvironmentMap random_map(int width, int height) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(0, 10);
  EnvironmentMap map;
  map.width = width;
  map.height = height;
  for (int i = 0; i < width * height; ++i) map.radiance.emplace_back(u(random), u(random), u(random));
  return map;
}

TEST(TurnedMap, ShowsWhatStoodThereBefore) {
  const EnvironmentMap map = random_map(16, 8);
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  // By whole columns exactly, whatever the number of turns.
  for (const int columns : {0, 1, 5, -3, 16, 37}) {
    const double turn_deg = 360.0 * columns / 16;
    const EnvironmentMap now = turned(map, turn_deg);
    for (int i = 0; i < 200; ++i) {
      const V3f w = V3f(normal(random), normal(random), normal(random)).normalized();
      const V3f before = w * turn_about_y(-turn_deg * radians_a_degree);
      // Rounding may take a direction at a column's edge to its neighbour.
      const float u = std::atan2(-w.x, w.z) / (2 * pi) * 16;
      if (std::abs(u - std::round(u)) < 1e-3F) continue;
      EXPECT_EQ(eval(now, w), eval(map, before)) << columns;
    }
  }
}

TEST(TurnedMap, KeepsEveryRowsFlux) {
  const EnvironmentMap map = random_map(12, 5);
  const EnvironmentMap now = turned(map, 40);
  EXPECT_FALSE(now.radiance == map.radiance);
  for (int y = 0; y < map.height; ++y) {
    double before = 0;
    double after = 0;
    for (int x = 0; x < map.width; ++x) {
      before += double(map.radiance[std::size_t(y * map.width + x)].y);
      after += double(now.radiance[std::size_t(y * map.width + x)].y);
    }
    EXPECT_NEAR(after, before, 1e-5 * before);
  }
}

TEST(FivSet, BlendsTheTwoNearestTurns) {
  const auto blend = [](int count, double degrees) { return blend_of_turn(count, degrees * radians_a_degree); };
  EXPECT_TRUE(blend(1, 0));
  EXPECT_TRUE(blend(1, 720));
  EXPECT_FALSE(blend(1, 1));
  EXPECT_FALSE(blend(1, -90));
  const auto expect = [&](double degrees, int first, int second, float share) {
    const auto found = blend(8, degrees);
    ASSERT_TRUE(found) << degrees;
    EXPECT_EQ(found->first, first) << degrees;
    if (share > 0) {
      EXPECT_EQ(found->second, second) << degrees;
    }
    EXPECT_NEAR(found->share, share, 1e-5F) << degrees;
  };
  expect(0, 0, 0, 0);
  expect(90, 2, 2, 0);
  expect(359.9999, 0, 0, 0);
  expect(-45, 7, 7, 0);
  expect(22.5, 0, 1, 0.5F);
  expect(-9, 7, 0, 0.8F);
  expect(360 + 50, 1, 2, 1 / 9.0F);
}

}  // namespace
}  // namespace ivory
