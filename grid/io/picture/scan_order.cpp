#include "grid/io/picture/scan_order.h"

#include <array>
#include <cstddef>
#include <utility>

namespace ivory {

std::optional<ScanOrder> scan_order_of_exif(int orientation) {
  // TIFF 6.0, page 36: where the file's first row and its first column are seen.
  constexpr std::array<ScanOrder, 8> orders{{{false, false, false},
                                             {false, false, true},
                                             {false, true, true},
                                             {false, true, false},
                                             {true, false, false},
                                             {true, false, true},
                                             {true, true, true},
                                             {true, true, false}}};
  if (orientation < 1 || orientation > 8) return std::nullopt;
  return orders[std::size_t(orientation - 1)];
}

std::vector<Rgb> upright(std::vector<Rgb> texels, int width, int height, const ScanOrder& order) {
  if (order == ScanOrder{}) return texels;
  std::vector<Rgb> out(texels.size());
  const auto w = std::size_t(width);
  const auto h = std::size_t(height);
  for (std::size_t row = 0; row < h; ++row) {
    for (std::size_t column = 0; column < w; ++column) {
      const std::size_t y = order.from_bottom ? h - 1 - row : row;
      const std::size_t x = order.from_right ? w - 1 - column : column;
      out[row * w + column] = texels[order.columns ? x * h + y : y * w + x];
    }
  }
  return out;
}

}  // namespace ivory
