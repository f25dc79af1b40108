// How a picture lays out the sphere of directions. Every layout is right-handed and never mirrored; with +Y up, the
// middle of the picture looks along +Z and +X lies to its left.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "grid/base/names.h"
#include "grid/env/cube_map.h"

namespace ivory {

enum class EnvironmentLayout {
  latlong,           // 2:1, grid/env/latlong_map.h
  angular,           // 1:1, light probe, grid/env/angular_map.h
  vertical_cross,    // 3:4: +Y / +X +Z -X / -Y / -Z, the last upside down
  horizontal_cross,  // 4:3: +Y above +Z in the second column, +X +Z -X -Z, -Y below +Z
  cube,              // 1:6, faces +X -X +Y -Y +Z -Z from top to bottom: OpenEXR's envmap = cube
  cube_row,          // 6:1, the same from left to right
};
template <>
inline constexpr auto name_table<EnvironmentLayout> =
    make_name_table<EnvironmentLayout>("layout", {{EnvironmentLayout::latlong, "latlong"},
                                                  {EnvironmentLayout::angular, "angular"},
                                                  {EnvironmentLayout::vertical_cross, "vertical_cross"},
                                                  {EnvironmentLayout::horizontal_cross, "horizontal_cross"},
                                                  {EnvironmentLayout::cube, "cube"},
                                                  {EnvironmentLayout::cube_row, "cube_row"}});

// Whether a picture of that size in pixels can have the layout, and what it must look like: "twice as wide as high".
bool fits(EnvironmentLayout layout, int width, int height);
std::string_view required_shape(EnvironmentLayout layout);

// The layout that an aspect ratio stands for; none for other ratios. Each ratio belongs to one layout, so nothing is
// ambiguous but pictures that only happen to have it.
std::optional<EnvironmentLayout> layout_of_aspect(int width, int height);

// The faces of a picture in one of the four cube layouts, width * height texels, top row first.
CubeMap cube_from_picture(EnvironmentLayout layout, std::span<const Rgb> texels, int width, int height);

}  // namespace ivory
