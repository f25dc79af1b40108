// The eight ways in which a picture's lines may lie in its file.
#pragma once

#include <optional>
#include <vector>

#include "grid/base/types.h"

namespace ivory {

struct ScanOrder {
  bool columns = false;      // the file's lines are columns of the picture
  bool from_bottom = false;  // what comes first is at the bottom
  bool from_right = false;   // what comes first is at the right

  bool operator==(const ScanOrder&) const = default;
};

// Of the tag Orientation of TIFF and Exif, 1 to 8; none for other numbers.
std::optional<ScanOrder> scan_order_of_exif(int orientation);

// The texels, of a picture that is seen as width x height, in rows from the top, each from the left.
std::vector<Rgb> upright(std::vector<Rgb> texels, int width, int height, const ScanOrder& order);

}  // namespace ivory
