// Means over squares of pixels.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace ivory {

// Means over squares of 2 radius + 1 pixels, of those in the picture.
template <typename T>
std::vector<T> box_mean(const std::vector<T>& values, int width, int height, int radius) {
  std::vector<T> rows(values.size());
  std::vector<T> means(values.size());
  const auto at = [&](int x, int y) { return std::size_t(y) * std::size_t(width) + std::size_t(x); };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      T sum = values[at(x, y)] * 0.0F;
      const int begin = std::max(0, x - radius);
      const int end = std::min(width - 1, x + radius);
      for (int i = begin; i <= end; ++i) sum += values[at(i, y)];
      rows[at(x, y)] = sum * (1.0F / float(end - begin + 1));
    }
  }
  for (int y = 0; y < height; ++y) {
    const int begin = std::max(0, y - radius);
    const int end = std::min(height - 1, y + radius);
    for (int x = 0; x < width; ++x) {
      T sum = values[at(x, y)] * 0.0F;
      for (int i = begin; i <= end; ++i) sum += rows[at(x, i)];
      means[at(x, y)] = sum * (1.0F / float(end - begin + 1));
    }
  }
  return means;
}

}  // namespace ivory
