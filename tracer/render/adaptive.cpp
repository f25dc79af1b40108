#include "tracer/render/adaptive.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace ivory {

namespace {

// In each half.
constexpr std::uint32_t least_half = least_samples / 2;
constexpr double most_growth = 2;          // of the picture's samples, in a round
constexpr double least_growth = 1.125;     // rounds that add less are not worth their barrier
constexpr std::uint32_t pixel_growth = 4;  // of a pixel's: one early sample that is far off must not decide all
// A pixel gets at least a quarter of what pixels get on average: that few samples agree is no proof.
constexpr double least_share = 0.25;
// Aims a little below the target, so that the last round seldom misses it.
constexpr double aim = 0.98;

double half_difference(const FilmSums& sums, std::size_t pixel) {
  return 0.5 * (double(luminance(sums.radiance(0, pixel))) - double(luminance(sums.radiance(1, pixel))));
}

// Variance of a sample of a half's, such that of the pixel's error it is that over its samples of each half.
std::vector<double> sample_variances(const FilmSums& sums) {
  std::vector<double> variance(sums.pixel_count());
  for (std::size_t i = 0; i < variance.size(); ++i) {
    const double difference = half_difference(sums, i);
    variance[i] = difference * difference * sums.samples[i];
  }
  return variance;
}

constexpr std::array<double, 5> kernel{1, 4, 6, 4, 1};

// The kernel's weights at place i of a line of `count`, of those that there are.
double weight_at(int i, int count) {
  double weight = 0;
  for (int k = std::max(0, i - 2); k <= std::min(count - 1, i + 2); ++k) weight += kernel[std::size_t(k - i + 2)];
  return weight;
}

void smooth_line(double* first, std::size_t stride, int count, std::vector<double>& line) {
  line.resize(std::size_t(count));
  for (int i = 0; i < count; ++i) line[std::size_t(i)] = first[std::size_t(i) * stride];
  for (int i = 0; i < count; ++i) {
    double sum = 0;
    for (int k = std::max(0, i - 2); k <= std::min(count - 1, i + 2); ++k)
      sum += kernel[std::size_t(k - i + 2)] * line[std::size_t(k)];
    first[std::size_t(i) * stride] = sum / weight_at(i, count);
  }
}

// Weighted means over the up to 24 pixels around each.
void average_neighbours(std::vector<double>& values, int width, int height) {
  const std::vector<double> own = values;
  std::vector<double> line;
  for (int y = 0; y < height; ++y) smooth_line(&values[std::size_t(y) * std::size_t(width)], 1, width, line);
  for (int x = 0; x < width; ++x) smooth_line(&values[std::size_t(x)], std::size_t(width), height, line);
  if (own.size() == 1) return;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
      const double share = kernel[2] * kernel[2] / (weight_at(x, width) * weight_at(y, height));
      values[i] = std::max(0.0, (values[i] - share * own[i]) / (1 - share));
    }
  }
}

// Up to steps of an eighth octave, at least four: their low-discrepancy points lie evenly.
std::uint32_t round_up(double samples, std::uint32_t most) {
  if (!(samples < double(most))) return most;
  const auto whole = std::max(std::uint32_t(std::ceil(samples)), 1U);
  const std::uint32_t step = std::max(4U, std::bit_floor(whole) / 8);
  return std::min(most, (whole + step - 1) / step * step);
}

struct Plan {
  const FilmSums& sums;
  std::vector<double> deviation;  // of a sample
  std::uint32_t most = 0;         // samples of a half

  std::uint32_t goal(std::size_t pixel, double rate) const {
    const std::uint32_t now = sums.samples[pixel];
    const std::uint32_t bound = std::max(now, std::min(most, now * pixel_growth));
    return std::max(now, round_up(rate * deviation[pixel], bound));
  }
  double total(double rate) const {
    double all = 0;
    for (std::size_t i = 0; i < deviation.size(); ++i) all += goal(i, rate);
    return all;
  }
  double squared_error(const std::vector<double>& variance, double rate) const {
    double all = 0;
    for (std::size_t i = 0; i < deviation.size(); ++i) all += variance[i] / goal(i, rate);
    return all / double(deviation.size());
  }
};

// The lowest rate for which `enough` holds, between one that adds nothing and one that adds all that may be.
template <typename Enough>
double lowest_rate(const Plan& plan, const Enough& enough) {
  double low = 1e300;
  double high = 0;
  for (std::size_t i = 0; i < plan.deviation.size(); ++i) {
    low = std::min(low, 0.5 / plan.deviation[i]);
    high = std::max(high, double(plan.most) / plan.deviation[i]);
  }
  for (int step = 0; step < 48 && high > low * 1.001; ++step) {
    const double middle = std::sqrt(low * high);
    (enough(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace

NoiseError measure_noise(const FilmSums& sums) {
  constexpr int side = 8;
  double mean = 0;
  double pixels = 0;
  double fourths = 0;
  double blocks = 0;
  for (int y0 = 0; y0 < sums.height; y0 += side) {
    for (int x0 = 0; x0 < sums.width; x0 += side) {
      const int y1 = std::min(y0 + side, sums.height);
      const int x1 = std::min(x0 + side, sums.width);
      double difference_of_block = 0;
      for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
          const std::size_t i = std::size_t(y) * std::size_t(sums.width) + std::size_t(x);
          const double difference = half_difference(sums, i);
          mean += double(luminance(sums.radiance(i)));
          pixels += difference * difference;
          fourths += difference * difference * difference * difference;
          difference_of_block += difference;
        }
      }
      // The square of the block's mean, once for each of its pixels.
      blocks += difference_of_block * difference_of_block / ((y1 - y0) * (x1 - x0));
    }
  }
  const auto count = double(sums.pixel_count());
  mean /= count;
  if (!(mean > 0)) return {};
  // A squared difference of normal variance s has the variance 2 s^2, and its own square the mean 3 s^2; the root of
  // the sum has half the relative error.
  const double relative = pixels > 0 ? 0.5 * std::sqrt(2.0 / 3.0 * fourths) / pixels : 0;
  const double pixel = std::sqrt(pixels / count) / mean;
  return {pixel, std::sqrt(blocks / count) / mean, relative * pixel};
}

std::vector<std::uint32_t> plan_round(const FilmSums& sums, const AdaptiveParams& params, double most_new) {
  const std::size_t count = sums.pixel_count();
  Plan plan{sums, {}, std::uint32_t(params.max_samples) / 2};
  if (sums.rounds == 0) return std::vector<std::uint32_t>(count, std::min(least_half, plan.most));
  std::vector<double> variance = sample_variances(sums);
  double measured = 0;
  double now = 0;
  double mean = 0;
  for (std::size_t i = 0; i < count; ++i) {
    measured += variance[i] / sums.samples[i] / double(count);
    now += sums.samples[i];
    mean += double(luminance(sums.radiance(i))) / double(count);
  }
  if (!(measured > 0) || !(mean > 0)) return {};
  average_neighbours(variance, sums.width, sums.height);
  plan.deviation.reserve(count);
  double mean_deviation = 0;
  for (const double v : variance) {
    plan.deviation.push_back(std::sqrt(v));
    mean_deviation += plan.deviation.back() / double(count);
  }
  for (double& deviation : plan.deviation) deviation = std::max(deviation, least_share * mean_deviation);

  // Averages move variance to where there are more or fewer samples: the scale is the measured one's.
  const double scale = measured / plan.squared_error(variance, 0);
  const NoiseError noise = measure_noise(sums);
  const double wanted = params.target * aim * mean * noise.pixel / (noise.pixel + noise.pixel_standard_error);
  double rate = lowest_rate(plan, [&](double r) {
    return params.target > 0 ? plan.squared_error(variance, r) * scale <= wanted * wanted
                             : plan.total(r) >= most_growth * now;
  });
  const double most_total = std::min(most_growth * now, now + 0.5 * most_new);
  if (plan.total(rate) > most_total) rate = lowest_rate(plan, [&](double r) { return plan.total(r) >= most_total; });
  if (plan.total(rate) < least_growth * now)
    rate = lowest_rate(plan, [&](double r) { return plan.total(r) >= least_growth * now; });
  if (!(plan.total(rate) > now)) return {};
  std::vector<std::uint32_t> goals(count);
  for (std::size_t i = 0; i < count; ++i) goals[i] = plan.goal(i, rate);
  return goals;
}

}  // namespace ivory
