#include "grid/env/layout.h"

#include <array>
#include <cassert>

namespace ivory {

namespace {

struct Shape {
  EnvironmentLayout layout;
  int across;  // width : height
  int down;
  std::string_view shape;
};

constexpr std::array<Shape, 6> shapes{{
    {EnvironmentLayout::latlong, 2, 1, "twice as wide as high"},
    {EnvironmentLayout::angular, 1, 1, "as wide as high"},
    {EnvironmentLayout::vertical_cross, 3, 4, "3 faces wide and 4 high"},
    {EnvironmentLayout::horizontal_cross, 4, 3, "4 faces wide and 3 high"},
    {EnvironmentLayout::cube, 1, 6, "1 face wide and 6 high"},
    {EnvironmentLayout::cube_row, 6, 1, "6 faces wide and 1 high"},
}};

const Shape& shape_of(EnvironmentLayout layout) {
  for (const Shape& shape : shapes) {
    if (shape.layout == layout) return shape;
  }
  return shapes[0];
}

// Where a face lies in the picture, in faces, and whether it stands on its head there. Unfolding the cube around +Z
// lays +Y, -Y (and in the vertical cross -Z) with the +Z face's -X to the right, against these faces' own right (+X):
// half a turn.
struct Place {
  int column;
  int row;
  bool turned;
};

Place place(EnvironmentLayout layout, int face) {
  constexpr std::array<Place, 6> vertical{
      {{0, 1, false}, {2, 1, false}, {1, 0, true}, {1, 2, true}, {1, 1, false}, {1, 3, true}}};
  constexpr std::array<Place, 6> horizontal{
      {{0, 1, false}, {2, 1, false}, {1, 0, true}, {1, 2, true}, {1, 1, false}, {3, 1, false}}};
  switch (layout) {
    case EnvironmentLayout::vertical_cross:
      return vertical[std::size_t(face)];
    case EnvironmentLayout::horizontal_cross:
      return horizontal[std::size_t(face)];
    case EnvironmentLayout::cube_row:
      return {face, 0, false};
    default:
      return {0, face, false};
  }
}

}  // namespace

bool fits(EnvironmentLayout layout, int width, int height) {
  const Shape& shape = shape_of(layout);
  return width > 0 && height > 0 && width % shape.across == 0 && height % shape.down == 0 &&
         width / shape.across == height / shape.down;
}

std::string_view required_shape(EnvironmentLayout layout) { return shape_of(layout).shape; }

std::optional<EnvironmentLayout> layout_of_aspect(int width, int height) {
  for (const Shape& shape : shapes) {
    if (fits(shape.layout, width, height)) return shape.layout;
  }
  return std::nullopt;
}

CubeMap cube_from_picture(EnvironmentLayout layout, std::span<const Rgb> texels, int width,
                          [[maybe_unused]] int height) {
  assert(fits(layout, width, height) && texels.size() == std::size_t(width) * std::size_t(height));
  const int size = width / shape_of(layout).across;
  CubeMap cube{size, std::vector<Rgb>(std::size_t(cube_faces) * std::size_t(size) * std::size_t(size))};
  for (int face = 0; face < cube_faces; ++face) {
    const Place at = place(layout, face);
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const int x = at.column * size + (at.turned ? size - 1 - column : column);
        const int y = at.row * size + (at.turned ? size - 1 - row : row);
        cube.texels[cube_index(size, face, row, column)] = texels[std::size_t(y) * std::size_t(width) + std::size_t(x)];
      }
    }
  }
  return cube;
}

}  // namespace ivory
