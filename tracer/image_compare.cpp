#include "tracer/image_compare.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace ivory {

ImageDifference compare_images(const Film& image, const Film& reference) {
  assert(image.width == reference.width && image.height == reference.height && !reference.pixels.empty());
  const double count = 3.0 * double(reference.pixels.size());
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  ImageDifference d;
  double squares = 0;
  for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double b = double(reference.pixels[i][c]);
      const double difference = double(image.pixels[i][c]) - b;
      low = std::min(low, b);
      high = std::max(high, b);
      d.reference_mean += b;
      d.bias += difference;
      squares += difference * difference;
      d.max = std::max(d.max, std::abs(difference));
    }
  }
  d.bias /= count;
  d.reference_mean /= count;
  d.rmse = std::sqrt(squares / count);
  d.nrmse = d.rmse == 0 ? 0 : d.rmse / (high - low);

  // The floor under b keeps black pixels from deciding everything.
  const double floor = 0.01 * d.reference_mean;
  double relative = 0;
  for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double b = double(reference.pixels[i][c]);
      const double difference = double(image.pixels[i][c]) - b;
      if (difference != 0) relative += difference * difference / (b * b + floor * floor);
    }
  }
  d.relative_rmse = std::sqrt(relative / count);
  return d;
}

}  // namespace ivory
