#include "grid/base/fast_angle.h"

#include <random>

#include <gtest/gtest.h>

namespace ivory {
namespace {

TEST(FastAngle, IsTheArcTangent) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  double worst = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    // All ratios, near the axes and the diagonals too.
    const auto y = float(i % 3 == 0 ? std::pow(unit(random), 15) : unit(random));
    const auto x = float(i % 7 == 0 ? y * (1 + 1e-3 * unit(random)) : unit(random));
    if (y == 0) continue;  // below 0 by less than a float can say
    worst = std::max(worst, std::abs(double(fast_angle(y, x)) - std::atan2(double(y), double(x))));
  }
  EXPECT_LT(worst, 6e-7);  // 2e-7 of up to pi/4, and roundings at pi
}

TEST(FastAngle, EdgesOfItsRange) {
  EXPECT_EQ(fast_angle(0, 0), 0);
  EXPECT_EQ(fast_angle(0, 1), 0);
  EXPECT_EQ(fast_angle(1, 0), 0.5F * pi);
  EXPECT_EQ(fast_angle(-1, 0), -0.5F * pi);
  EXPECT_EQ(fast_angle(0, -1), pi);
  EXPECT_FLOAT_EQ(fast_angle(1e-38F, 1e-38F), 0.25F * pi);
  EXPECT_FLOAT_EQ(fast_angle(3e38F, -3e38F), 0.75F * pi);
}

}  // namespace
}  // namespace ivory
