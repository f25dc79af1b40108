// Objects that are moved, turned and scaled.
#include "grid/base/placement.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace ivory {
namespace {

TEST(Placement, QuartersTurnAxesIntoOneAnother) {
  const auto turned = [](const V3f& turn_deg, const V3f& p) {
    return placed(Placement{V3f(0, 0, 0), turn_deg, 1, V3f(0, 0, 0)}, p);
  };
  // Counter-clockwise seen from the axis's end: y to z about x, z to x about y, x to y about z; exactly.
  EXPECT_EQ(turned(V3f(90, 0, 0), V3f(0, 1, 0)), V3f(0, 0, 1));
  EXPECT_EQ(turned(V3f(0, 90, 0), V3f(0, 0, 1)), V3f(1, 0, 0));
  EXPECT_EQ(turned(V3f(0, 0, 90), V3f(1, 0, 0)), V3f(0, 1, 0));
  EXPECT_EQ(turned(V3f(0, 450, 0), V3f(0, 0, 1)), V3f(1, 0, 0));
  EXPECT_EQ(turned(V3f(0, -180, 0), V3f(1, 2, 3)), V3f(-1, 2, -3));
  // About x, then z, then y: y goes to z, stays, and goes on to x.
  EXPECT_EQ(turned(V3f(90, 90, 90), V3f(0, 1, 0)), V3f(1, 0, 0));
  EXPECT_EQ(turned(V3f(90, 90, 90), V3f(1, 0, 0)), V3f(0, 1, 0));
  EXPECT_LT((V3f(0, 0, 1) * turn_about_y(0.3) - V3f(std::sin(0.3F), 0, std::cos(0.3F))).length(), 1e-7F);
}

TEST(Placement, MatrixPlacesAndComesBack) {
  EXPECT_TRUE(to_matrix(Placement{}) == M44f());
  std::mt19937 random(1);
  std::uniform_real_distribution<float> u(-1, 1);
  const auto vector = [&](float size) { return V3f(u(random), u(random), u(random)) * size; };
  for (int i = 0; i < 500; ++i) {
    const Placement placement{vector(3), vector(400), std::exp(u(random)), vector(2)};
    const V3f p = vector(2);
    const V3f there = placed(placement, p);
    // Numbers up to some tens, to their rounding.
    EXPECT_LT((p * to_matrix(placement) - there).length(), 2e-5F);
    EXPECT_LT((unplaced(placement, there) - p).length(), 2e-5F);
    // What it turns about goes with the offset alone, and distances grow by the scale.
    EXPECT_LT((placed(placement, placement.pivot_m) - placement.pivot_m - placement.offset_m).length(), 1e-5F);
    EXPECT_NEAR((placed(placement, p) - placed(placement, V3f(0, 0, 0))).length(), placement.scale * p.length(), 2e-5F);
  }
}

}  // namespace
}  // namespace ivory
