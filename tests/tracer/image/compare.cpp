// Comparing with one noisy reference and with two.
#include "tracer/image/compare.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"

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

// Of standard deviation sigma times the truth, never below zero.
Film with_relative_noise(Film film, double sigma, std::mt19937& random) {
  std::gamma_distribution<float> gamma(float(1 / (sigma * sigma)), float(sigma * sigma));
  for (Rgb& pixel : film.pixels) pixel *= Rgb(gamma(random), gamma(random), gamma(random));
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

// A picture 10 % too bright or too dark, references with noise of sigma = 0.4 of the truth, as skewed as sums of few
// paths are (gamma distribution of shape 1/sigma^2): relative_rmse^2 of 40 pairs has the mean 0.01 (floor: 1e-4 of it).
// Each pair's standard error is 0.16 / sqrt(9984) = 0.0017, so that none is cut off at zero; that of their mean,
// 0.00027, also covers the divisor's noise, 1 % of 0.01. Divided by the pixel's own (b + c)/2 the mean would be off by
// about 2 (+-0.1) 0.16 + 1.5 0.0256: by 0.070 for the bright picture, 0.006 for the dark one.
TEST(ImageCompare, RelativeErrorIsNotBiasedByTheNoise) {
  constexpr double sigma = 0.4;
  const Film truth = ramp(64, 52);
  std::mt19937 random(11);
  for (const float off : {0.1F, -0.1F}) {
    Film image = truth;
    for (Rgb& pixel : image.pixels) pixel *= 1 + off;
    Accumulator squares;
    for (int i = 0; i < 40; ++i) {
      const Film b = with_relative_noise(truth, sigma, random);
      const Film c = with_relative_noise(truth, sigma, random);
      squares.add(std::pow(compare_images(image, b, c).relative_rmse, 2));
    }
    EXPECT_LT(std::abs(z_score(squares, 0.01)), z_limit) << off << ": " << squares.mean();
    EXPECT_LT(squares.standard_error(), 0.0005);
  }
}

// A perfect picture: its mean square is within 4 standard errors, sigma^2 / sqrt(values), of zero (a false alarm once
// in 30,000 references, the test being one-sided), where divided by the pixel's own (b + c)/2 it would be beyond 180.
// What is stated as standard error where the mean square is not above a quarter of its own is that error's root; 3,120
// blocks tell it to 1.3 %, its root to 0.6 %.
TEST(ImageCompare, PerfectPictureHasNoRelativeError) {
  constexpr double sigma = 0.4;
  const Film truth = ramp(512, 390);
  const double mean_error = sigma * sigma / std::sqrt(512.0 * 390 * 3);
  bool at_most = false;
  std::mt19937 random(12);
  for (int i = 0; i < 6; ++i) {
    const Film b = with_relative_noise(truth, sigma, random);
    const Film c = with_relative_noise(truth, sigma, random);
    const ImageDifference d = compare_images(truth, b, c);
    EXPECT_LT(std::pow(d.relative_rmse, 2), 4 * mean_error);
    EXPECT_NEAR(d.reference_relative_rmse, sigma / std::sqrt(2.0), 0.01 * sigma);
    if (d.relative_rmse > 0) continue;
    at_most = true;
    EXPECT_NEAR(d.relative_rmse_standard_error, std::sqrt(mean_error), 0.04 * std::sqrt(mean_error));
  }
  EXPECT_TRUE(at_most);  // one in 64 choices of a seed has no mean below zero
}

TEST(ImageCompare, EqualReferencesAreOne) {
  const Film truth = ramp(20, 9);
  Film image = truth;
  image.at(3, 4).y += 1;
  const ImageDifference one = compare_images(image, truth);
  const ImageDifference two = compare_images(image, truth, truth);
  EXPECT_EQ(one.nrmse, two.nrmse);
  EXPECT_EQ(two.reference_nrmse, 0);
  EXPECT_EQ(two.reference_relative_rmse, 0);
  EXPECT_NEAR(one.rmse, std::sqrt(1.0 / (20 * 9 * 3)), 1e-9);
  EXPECT_GT(one.nrmse_standard_error, 0);
  EXPECT_EQ(compare_images(truth, truth, truth).nrmse_standard_error, 0);
}

// Divisors of two references by hand: means over the others of the 5x5, cut off at the picture's edges.
TEST(ImageCompare, DividesByTheMeanAround) {
  Film b{4, 1, {Rgb(1, 1, 1), Rgb(2, 2, 2), Rgb(3, 3, 3), Rgb(6, 6, 6)}};
  const Film c{4, 1, {Rgb(3, 3, 3), Rgb(4, 4, 4), Rgb(1, 1, 1), Rgb(4, 4, 4)}};  // means with b: 2 3 2 5
  Film image{4, 1, {Rgb(4, 4, 4), Rgb(3, 3, 3), Rgb(2, 2, 2), Rgb(5, 5, 5)}};
  const double floor = 0.03 * 0.03;
  const double first = 3 * 1 / (2.5 * 2.5 + floor);  // (4 - 1) (4 - 3), beside 3 and 2
  const double second = -1 / (9 + floor);            // beside 2, 2 and 5
  const double third = -1 / (100.0 / 9 + floor);     // beside 2, 3 and 5
  const double fourth = -1 / (2.5 * 2.5 + floor);    // beside 3 and 2
  const ImageDifference d = compare_images(image, b, c);
  EXPECT_NEAR(d.relative_rmse, std::sqrt((first + second + third + fourth) / 4), 1e-12);
  const ImageDifference alone = compare_images({1, 1, {Rgb(3, 3, 3)}}, {1, 1, {Rgb(2, 2, 2)}}, {1, 1, {Rgb(2, 2, 2)}});
  EXPECT_NEAR(alone.relative_rmse, 1 / std::sqrt(4 + 0.02 * 0.02), 1e-12);
}

}  // namespace
}  // namespace ivory
