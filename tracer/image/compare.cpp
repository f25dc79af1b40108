#include "tracer/image/compare.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

// Own code: OpenImageIO's compare() knows neither relative errors, nor noise in the reference, nor standard errors.

namespace ivory {

namespace {

// The mean over a picture and the mean's standard error, from the spread of the means of blocks: neighbouring
// pixels err alike.
class BlockMean {
 public:
  BlockMean(int width, int height)
      : columns_((width + block - 1) / block),
        sums_(std::size_t(columns_) * std::size_t((height + block - 1) / block)) {}

  void add(int x, int y, double value) {
    Sum& sum = sums_[std::size_t(y / block) * std::size_t(columns_) + std::size_t(x / block)];
    sum.value += value;
    sum.count += 1;
  }
  double mean() const {
    Sum all;
    for (const Sum& sum : sums_) {
      all.value += sum.value;
      all.count += sum.count;
    }
    return all.value / all.count;
  }
  // Of a ratio of sums (Cochran 1977, eq. 6.13): blocks at the border are smaller.
  double standard_error() const {
    const double whole = mean();
    double squares = 0;
    double count = 0;
    for (const Sum& sum : sums_) {
      squares += std::pow(sum.value - whole * sum.count, 2);
      count += sum.count;
    }
    const double n = double(sums_.size());
    return n < 2 ? 0 : std::sqrt(squares * n / (n - 1)) / count;
  }

 private:
  static constexpr int block = 8;
  struct Sum {
    double value = 0;
    double count = 0;
  };
  int columns_;
  std::vector<Sum> sums_;
};

double root(double mean) { return std::sqrt(std::max(0.0, mean)); }

// Of sqrt(m) by the slope at m; where m is not above its own error, of the whole range that it may lie in.
double standard_error_of_root(const BlockMean& m) {
  const double error = m.standard_error();
  return error == 0 ? 0 : error / (2 * root(std::max(m.mean(), error / 4)));
}

// Of (b + c)/2 over the 5x5 around a pixel without itself; its own where it is alone.
V3d mean_around(const Film& b, const Film& c, int x, int y) {
  constexpr int reach = 2;
  V3d sum(0, 0, 0);
  int count = 0;
  for (int v = std::max(0, y - reach); v <= std::min(b.height - 1, y + reach); ++v) {
    for (int u = std::max(0, x - reach); u <= std::min(b.width - 1, x + reach); ++u) {
      if (u == x && v == y) continue;
      sum += V3d(b.at(u, v)) + V3d(c.at(u, v));
      ++count;
    }
  }
  return count == 0 ? (V3d(b.at(x, y)) + V3d(c.at(x, y))) / 2 : sum / (2 * count);
}

// With one reference both of its roles are b's.
enum class References { one, two };

ImageDifference compare(const Film& image, const Film& b, const Film& c, References references) {
  assert(image.width == b.width && image.height == b.height && !b.pixels.empty());
  assert(image.width == c.width && image.height == c.height);
  const double count = 3.0 * double(b.pixels.size());
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  ImageDifference d;
  for (std::size_t i = 0; i < b.pixels.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const double truth = (double(b.pixels[i][k]) + double(c.pixels[i][k])) / 2;
      const double difference = double(image.pixels[i][k]) - truth;
      low = std::min(low, truth);
      high = std::max(high, truth);
      d.reference_mean += truth / count;
      d.bias += difference / count;
      d.max = std::max(d.max, std::abs(difference));
    }
  }

  // The floor keeps black pixels from deciding everything.
  const double floor = 0.01 * d.reference_mean;
  BlockMean squares(b.width, b.height);
  BlockMean relative(b.width, b.height);
  double noise = 0;
  double relative_noise = 0;
  for (int y = 0; y < b.height; ++y) {
    for (int x = 0; x < b.width; ++x) {
      const V3d level = references == References::one ? V3d(b.at(x, y)) : mean_around(b, c, x, y);
      for (int k = 0; k < 3; ++k) {
        const double first = double(b.at(x, y)[k]);
        const double second = double(c.at(x, y)[k]);
        const double a = double(image.at(x, y)[k]);
        const double square = (a - first) * (a - second);
        const double divisor = level[k] * level[k] + floor * floor;
        const double spread = std::pow((first - second) / 2, 2);
        squares.add(x, y, square);
        relative.add(x, y, square == 0 ? 0 : square / divisor);
        noise += spread / count;
        relative_noise += spread == 0 ? 0 : spread / divisor / count;
      }
    }
  }
  const auto of_range = [&](double value) { return value == 0 ? 0 : value / (high - low); };
  d.rmse = root(squares.mean());
  d.nrmse = of_range(d.rmse);
  d.relative_rmse = root(relative.mean());
  d.nrmse_standard_error = of_range(standard_error_of_root(squares));
  d.relative_rmse_standard_error = standard_error_of_root(relative);
  d.reference_nrmse = of_range(std::sqrt(noise));
  d.reference_relative_rmse = std::sqrt(relative_noise);
  return d;
}

}  // namespace

ImageDifference compare_images(const Film& image, const Film& reference) {
  return compare(image, reference, reference, References::one);
}

ImageDifference compare_images(const Film& image, const Film& reference, const Film& second_reference) {
  return compare(image, reference, second_reference, References::two);
}

}  // namespace ivory
