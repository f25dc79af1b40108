// Pictures of a known function of direction in every layout, written from each layout's definition without the
// code under test.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "grid/base/types.h"
#include "grid/env/layout.h"

namespace ivory {

inline constexpr std::array<EnvironmentLayout, 6> all_layouts{
    EnvironmentLayout::latlong,          EnvironmentLayout::angular, EnvironmentLayout::vertical_cross,
    EnvironmentLayout::horizontal_cross, EnvironmentLayout::cube,    EnvironmentLayout::cube_row};

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<Rgb> texels;
};

// Looking from the centre of a cube of half edge 1 at a face laid out in the picture: a unit step right and a unit
// step down there.
struct PicturedFace {
  int column, row;  // in faces
  V3d forward, right, down;
};

inline std::vector<PicturedFace> pictured_faces(EnvironmentLayout layout) {
  const V3d x(1, 0, 0);
  const V3d y(0, 1, 0);
  const V3d z(0, 0, 1);
  switch (layout) {
    case EnvironmentLayout::vertical_cross:
      // Folded from +Z in the middle; from there up to +Y one sees the same -X to the right, and so on round.
      return {{1, 1, z, -x, -y}, {0, 1, x, z, -y},   {2, 1, -x, -z, -y},
              {1, 0, y, -x, z},  {1, 2, -y, -x, -z}, {1, 3, -z, -x, y}};
    case EnvironmentLayout::horizontal_cross:
      return {{1, 1, z, -x, -y}, {0, 1, x, z, -y},   {2, 1, -x, -z, -y},
              {1, 0, y, -x, z},  {1, 2, -y, -x, -z}, {3, 1, -z, x, -y}};
    case EnvironmentLayout::cube:
      return {{0, 0, x, z, -y}, {0, 1, -x, -z, -y}, {0, 2, y, x, -z},
              {0, 3, -y, x, z}, {0, 4, z, -x, -y},  {0, 5, -z, x, -y}};
    case EnvironmentLayout::cube_row:
      return {{0, 0, x, z, -y}, {1, 0, -x, -z, -y}, {2, 0, y, x, -z},
              {3, 0, -y, x, z}, {4, 0, z, -x, -y},  {5, 0, -z, x, -y}};
    default:
      return {};
  }
}

// Direction of a point of the picture, in texels; none where the layout shows nothing there.
inline std::optional<V3d> picture_direction(EnvironmentLayout layout, int width, int height, double column,
                                            double row) {
  constexpr double pi_d = 3.14159265358979323846;
  if (layout == EnvironmentLayout::latlong) {
    const double longitude = pi_d * (1 - 2 * column / width);  // +X at a quarter of the width
    const double latitude = pi_d * (0.5 - row / height);
    return V3d(std::cos(latitude) * std::sin(longitude), std::sin(latitude), std::cos(latitude) * std::cos(longitude));
  }
  if (layout == EnvironmentLayout::angular) {
    const double u = 2 * column / width - 1;
    const double v = 2 * row / height - 1;
    const double r = std::hypot(u, v);
    if (r >= 1) return std::nullopt;
    const double s = r > 0 ? std::sin(pi_d * r) / r : pi_d;
    return V3d(-u * s, -v * s, std::cos(pi_d * r));
  }
  const int size = layout == EnvironmentLayout::vertical_cross     ? width / 3
                   : layout == EnvironmentLayout::horizontal_cross ? width / 4
                   : layout == EnvironmentLayout::cube             ? width
                                                                   : height;
  for (const PicturedFace& face : pictured_faces(layout)) {
    const double s = 2 * (column / size - face.column) - 1;
    const double t = 2 * (row / size - face.row) - 1;
    if (std::abs(s) < 1 && std::abs(t) < 1) return (face.forward + face.right * s + face.down * t).normalized();
  }
  return std::nullopt;
}

// `detail` texels from +X to +Z along the equator. Each texel is the mean of 3 x 3 points of it. What shows nothing
// is bright, to be ignored by the reader.
inline Picture make_picture(EnvironmentLayout layout, int detail, const std::function<Rgb(const V3d&)>& radiance) {
  Picture picture;
  switch (layout) {
    case EnvironmentLayout::latlong:
      picture = {4 * detail, 2 * detail, {}};
      break;
    case EnvironmentLayout::angular:
      picture = {4 * detail, 4 * detail, {}};
      break;
    case EnvironmentLayout::vertical_cross:
      picture = {3 * detail, 4 * detail, {}};
      break;
    case EnvironmentLayout::horizontal_cross:
      picture = {4 * detail, 3 * detail, {}};
      break;
    case EnvironmentLayout::cube:
      picture = {detail, 6 * detail, {}};
      break;
    case EnvironmentLayout::cube_row:
      picture = {6 * detail, detail, {}};
      break;
  }
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      V3d sum(0, 0, 0);
      int points = 0;
      for (int i = 0; i < 9; ++i) {
        const auto w = picture_direction(layout, picture.width, picture.height, column + (i % 3 + 0.5) / 3,
                                         row + (i / 3 + 0.5) / 3);
        if (!w) continue;
        sum += V3d(radiance(*w));
        ++points;
      }
      if (points == 0 && layout == EnvironmentLayout::angular) {
        // The rim may cut a corner off that holds none of the points.
        const double u = 2 * (column + 0.5) / picture.width - 1;
        const double v = 2 * (row + 0.5) / picture.height - 1;
        const double r = std::hypot(u, v) * (1 + 1e-9);
        if (r < 1 + 1.5 / picture.width) {
          sum = V3d(radiance(*picture_direction(layout, 2, 2, 1 + u / r, 1 + v / r)));
          points = 1;
        }
      }
      picture.texels.push_back(points > 0 ? Rgb(sum / points) : Rgb(1000, 1000, 1000));
    }
  }
  return picture;
}

}  // namespace ivory
