// Localized cube maps made in memory, for sweeps and tests.
#pragma once

#include <algorithm>
#include <functional>
#include <random>

#include "grid/cubemap/localized.h"

namespace ivory {

using Depth = std::function<float(const V3d& w)>;  // inverse distance (1/m) along unit w
using Light = std::function<Rgb(const V3f& w)>;    // nits along unit w

// A map of what a tracer with endless samples would find in the corners and centres of texels.
inline LocalizedCube make_cube(int size, const V3f& origin, const Depth& inverse_distance, const Light& light) {
  LocalizedCube cube;
  cube.origin_m = origin;
  cube.radiance.size = size;
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        cube.radiance.texels.push_back(light(cube_texel_direction(size, face, row, column)));
        TexelCorners v{};
        for (int k = 0; k < 4; ++k) {
          const V3d q = cube_point(face, cube_edge(size, column + k % 2), cube_edge(size, row + k / 2));
          v[std::size_t(k)] = float(inverse_distance(q.normalized()) * q.length());
        }
        cube.corners.push_back(v);
      }
    }
  }
  return cube;
}

inline Rgb white(const V3f&) { return {1, 1, 1}; }

// Inverse distance to the walls of a box around the origin of w.
inline Depth box_around(const V3d& low, const V3d& high) {
  return [=](const V3d& w) {
    double v = 0;
    for (int c = 0; c < 3; ++c) v = std::max(v, w[c] / (w[c] > 0 ? high[c] : low[c]));
    return float(v);
  };
}

inline V3f random_unit(std::mt19937& random) {
  std::normal_distribution<float> normal;
  V3f w(0, 0, 0);
  while (w.length() < 1e-3F) {
    for (unsigned c = 0; c < 3; ++c) w[c] = normal(random);  // in an order that is not the compiler's choice
  }
  return w.normalized();
}

}  // namespace ivory
