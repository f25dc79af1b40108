// Laying boxes out in one, as 3D textures of several tables are.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "grid/base/types.h"

namespace ivory {

struct PackedBoxes {
  V3i size{0, 0, 0};         // of the whole, texels
  std::vector<V3i> corners;  // where each box begins, in the order given
};

// Large boxes first, each into the smallest gap that holds it, or else where the whole grows least. Boxes never
// overlap. Empty where the whole would have more than `limit` along an axis.
std::optional<PackedBoxes> pack_boxes(std::span<const V3i> boxes, int limit);

}  // namespace ivory
