#include "grid/base/circle.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace ivory {
namespace {

TEST(OnUnitCircle, IsSineAndCosine) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-3, 3);
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    const double turns = uniform(random);
    const Imath::V2d p = on_unit_circle(turns);
    const long double angle = 2 * std::numbers::pi_v<long double> * static_cast<long double>(turns);
    worst = std::max(worst, double(std::abs(p.x - std::cos(angle))));
    worst = std::max(worst, double(std::abs(p.y - std::sin(angle))));
  }
  // Two units in the last place of 1: the reduced angle is rounded once, and the sums' last steps.
  EXPECT_LT(worst, 2.3e-16);
}

TEST(OnUnitCircle, HitsTheAxesAndIsContinuousBetweenEighths) {
  EXPECT_EQ(on_unit_circle(0), Imath::V2d(1, 0));
  EXPECT_EQ(on_unit_circle(0.25), Imath::V2d(0, 1));
  EXPECT_EQ(on_unit_circle(0.5), Imath::V2d(-1, 0));
  EXPECT_EQ(on_unit_circle(-0.25), Imath::V2d(0, -1));
  EXPECT_EQ(on_unit_circle(1), Imath::V2d(1, 0));
  for (int k = -16; k <= 16; ++k) {
    const double turns = k / 8.0;
    const Imath::V2d before = on_unit_circle(std::nextafter(turns, -10.0));
    const Imath::V2d after = on_unit_circle(std::nextafter(turns, 10.0));
    // Two steps of at most 2^-52 * 2 turns apart.
    EXPECT_LT((before - after).length(), 1e-14) << turns;
  }
}

}  // namespace
}  // namespace ivory
