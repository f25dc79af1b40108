// Comparing with one noisy reference and with two.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/statistics.h"
#include "tracer/image_compare.h"

namespace ivory {
namespace {

Film ramp(int width, int height) {
  Film film{width, height, {}};
  for (int i = 0; i < width * height; ++i) film.pixels.emplace_back(1 + float(i % width) / float(width), 1.5F, 1.2F);
  return film;
}

Film with_noise(Film film, float sigma, std::mt19937& random) {
  std::normal_distribution<float> normal(0, sigma);
  for (Rgb& pixel : film.pixels) pixel += Rgb(normal(random), normal(random), normal(random));
  return film;
}

// An image off by 0.05 everywhere, references with noise of 0.2: one reference sees sqrt(0.05^2 + 0.2^2), two see 0.05,
// with standard errors that hold: 40 pairs make a z-score of their mean, and the errors stated are those found to 30 %
// (40 samples tell a standard deviation to 11 %).
TEST(ImageCompare, TwoReferencesLeaveTheirNoiseOut) {
  std::mt19937 random(5);
  const Film truth = ramp(64, 52);
  Film image = truth;
  for (Rgb& pixel : image.pixels) pixel += Rgb(0.05F, -0.05F, 0.05F);
  Accumulator squares;
  Accumulator roots;
  double stated = 0;
  double floor = 0;
  for (int i = 0; i < 40; ++i) {
    const Film a = with_noise(truth, 0.2F, random);
    const Film b = with_noise(truth, 0.2F, random);
    const ImageDifference one = compare_images(image, a);
    EXPECT_NEAR(one.rmse, std::hypot(0.05, 0.2), 0.01);
    EXPECT_EQ(one.reference_nrmse, 0);
    const ImageDifference two = compare_images(image, a, b);
    const double range = two.rmse / two.nrmse;
    squares.add(two.rmse * two.rmse);
    roots.add(two.rmse);
    stated += two.nrmse_standard_error * range / 40;
    floor += two.reference_nrmse * range / 40;
    EXPECT_GT(two.relative_rmse_standard_error, 0);
  }
  EXPECT_LT(std::abs(z_score(squares, 0.05 * 0.05)), z_limit);
  EXPECT_NEAR(stated, std::sqrt(roots.variance()), 0.3 * stated);
  EXPECT_NEAR(floor, 0.2 / std::sqrt(2.0), 0.003);  // of the mean of two, 10,000 values a pair
}

TEST(ImageCompare, EqualReferencesAreOne) {
  const Film truth = ramp(20, 9);
  Film image = truth;
  image.at(3, 4).y += 1;
  const ImageDifference one = compare_images(image, truth);
  const ImageDifference two = compare_images(image, truth, truth);
  EXPECT_EQ(one.nrmse, two.nrmse);
  EXPECT_EQ(one.relative_rmse, two.relative_rmse);
  EXPECT_EQ(two.reference_nrmse, 0);
  EXPECT_NEAR(one.rmse, std::sqrt(1.0 / (20 * 9 * 3)), 1e-9);
  EXPECT_GT(one.nrmse_standard_error, 0);
  EXPECT_EQ(compare_images(truth, truth, truth).nrmse_standard_error, 0);
}

}  // namespace
}  // namespace ivory
