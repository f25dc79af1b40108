#include "tools/bench/measure_env.h"

#include <algorithm>
#include <array>
#include <utility>
#include <variant>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace ivory {

EnvironmentImage make_bench_environment(int width, int height) {
  EnvironmentMap map{width, height, {}};
  map.radiance.reserve(std::size_t(width) * std::size_t(height));
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column)
      map.radiance.emplace_back(float(1 + row % 17), float(1 + column % 13), float(1 + (row ^ column) % 11));
  }
  return {EnvironmentLayout::latlong, std::move(map)};
}

V3d sum_pixels(const EnvironmentImage& latlong) {
  const auto& pixels = std::get<EnvironmentMap>(latlong.map).radiance;
  constexpr std::size_t chunks = 64;
  constexpr std::size_t lanes = 12;
  std::array<V3d, chunks> parts;
  tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t chunk) {
    const std::size_t begin = pixels.size() * chunk / chunks;
    const std::size_t end = pixels.size() * (chunk + 1) / chunks;
    const float* const values = &pixels[begin].x;
    const std::size_t count = 3 * (end - begin);
    double sums[lanes] = {};
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes)
      for (std::size_t k = 0; k < lanes; ++k) sums[k] += double(values[i + k]);
    for (std::size_t k = 0; i < count; ++i, ++k) sums[k] += double(values[i]);
    V3d& part = parts[chunk];
    part = V3d(0, 0, 0);
    for (std::size_t k = 0; k < lanes; ++k) part[int(k % 3)] += sums[k];
  });
  V3d sum(0, 0, 0);
  for (const V3d& part : parts) sum += part;
  return sum;
}

void copy_bytes(const std::vector<float>& from, std::vector<float>& to) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, from.size(), 1 << 16), [&](const auto& range) {
    std::copy(from.begin() + std::ptrdiff_t(range.begin()), from.begin() + std::ptrdiff_t(range.end()),
              to.begin() + std::ptrdiff_t(range.begin()));
  });
}

}  // namespace ivory
