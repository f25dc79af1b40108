// Colours for numbers: the false-colour views and their legend.
#pragma once

#include <array>

#include "grid/base/types.h"

namespace ivory {

// Display values (sRGB, 0 to 1) at 17 even steps of the value, joined by lines.
using ColorMap = std::array<V3f, 17>;

// From small to large.
const ColorMap& sequential_colors();
// Below zero blue, zero grey, above red.
const ColorMap& signed_colors();

// `x` from 0 to 1; others take the end's colour.
V3f color_at(const ColorMap& map, float x);

}  // namespace ivory
