#include "grid/export/atlas.h"

#include <algorithm>
#include <cmath>

namespace ivory {

Atlas padded_atlas(const V3i& size, int blocks, const std::function<V4f(int block, std::size_t probe)>& texel) {
  Atlas atlas;
  atlas.size = V3i(size.x, size.y, blocks * (size.z + 2));
  atlas.texels.reserve(std::size_t(atlas.size.x) * std::size_t(atlas.size.y) * std::size_t(atlas.size.z));
  const std::size_t slice = std::size_t(size.x) * std::size_t(size.y);
  for (int block = 0; block < blocks; ++block) {
    for (int k = -1; k <= size.z; ++k) {
      const auto z = std::size_t(std::clamp(k, 0, size.z - 1));
      for (std::size_t i = 0; i < slice; ++i) atlas.texels.push_back(texel(block, z * slice + i));
    }
  }
  return atlas;
}

Atlas bevy_atlas(const V3i& size, const std::function<V4f(std::size_t side, std::size_t probe)>& texel) {
  Atlas atlas;
  atlas.size = V3i(size.x, 2 * size.y, 3 * size.z);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < size.z; ++k) {
      for (std::size_t negative = 0; negative < 2; ++negative) {
        for (int j = 0; j < size.y; ++j) {
          for (int i = 0; i < size.x; ++i) {
            const std::size_t probe =
                (std::size_t(k) * std::size_t(size.y) + std::size_t(j)) * std::size_t(size.x) + std::size_t(i);
            atlas.texels.push_back(texel(2 * axis + negative, probe));
          }
        }
      }
    }
  }
  return atlas;
}

float largest_channel(const Atlas& atlas) {
  float largest = 0;
  for (const V4f& texel : atlas.texels)
    largest = std::max({largest, std::abs(texel.x), std::abs(texel.y), std::abs(texel.z)});
  return largest;
}

}  // namespace ivory
