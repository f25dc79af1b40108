#include "grid/env/irradiance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <tbb/parallel_for.h>

namespace ivory {

namespace {

RadianceMoments moments_of_rows(const EnvironmentImage& image, int begin, int end) {
  if (const auto* map = std::get_if<EnvironmentMap>(&image.map))
    return latlong_moments(map->radiance, map->width, map->height, begin, end);
  if (const auto* cube = std::get_if<CubeMap>(&image.map)) return cube_moments(*cube, begin, end);
  return angular_moments(std::get<AngularMap>(image.map), begin, end);
}

int row_count(const EnvironmentImage& image) {
  if (const auto* map = std::get_if<EnvironmentMap>(&image.map)) return map->height;
  if (const auto* cube = std::get_if<CubeMap>(&image.map)) return cube->size;
  return std::get<AngularMap>(image.map).size;
}

// How often a texel is divided along each edge, for at least `rows` rows.
int division(int have, int rows) { return std::max(1, (rows + have - 1) / have); }

// A power of two whose six squares hold about as many cells as there are texels, from 16 to 256: finer cells would cost
// more memory than the little they sharpen the horizon.
int tree_size(double texels) {
  int size = 16;
  while (size < 256 && 6.0 * size * size < 0.75 * texels) size *= 2;
  return size;
}

IrradianceTree latlong_tree(const EnvironmentMap& map) {
  const int k = division(map.height, 256);
  const int width = map.width * k;
  const int height = map.height * k;
  IrradianceTree tree(tree_size(double(width) * height));
  const LatLongTexels texels(width, height);
  for (int row = 0; row < height; ++row) {
    const Rgb* const radiance = map.radiance.data() + std::size_t(row / k) * std::size_t(map.width);
    // Half a row up or down, and half a column along the wider of its edges.
    const double widest = row < height / 2 ? (row + 1) * std::numbers::pi / height : row * std::numbers::pi / height;
    const double half_angle = std::numbers::pi / height / 2 + std::numbers::pi / width * std::sin(widest);
    for (int column = 0; column < width; ++column) {
      const TexelMoments moments = texels(row, column);
      tree.add(radiance[column / k], moments.solid_angle, moments.first, half_angle);
    }
  }
  tree.finish();
  return tree;
}

IrradianceTree cube_tree(const CubeMap& map) {
  const int k = division(map.size, 128);
  const int size = map.size * k;
  IrradianceTree tree(tree_size(6.0 * size * size));
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const TexelMoments moments = cube_texel_moments(size, row, column);
      for (int face = 0; face < cube_faces; ++face) {
        const CubeFaceAxes& axes = cube_face_axes(face);
        const V3d first =
            V3d(axes.right) * moments.first.x + V3d(axes.down) * moments.first.y + V3d(axes.forward) * moments.first.z;
        // Half the diagonal on the face, seen from the centre at a distance of one or more.
        tree.add(map.texels[cube_index(map.size, face, row / k, column / k)], moments.solid_angle, first,
                 std::sqrt(2.0) / size);
      }
    }
  }
  tree.finish();
  return tree;
}

IrradianceTree angular_tree(const AngularMap& map) {
  const int k = division(map.size, 256);
  const int size = map.size * k;
  IrradianceTree tree(tree_size(double(size) * size));
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const TexelMoments moments = angular_texel_moments(size, row, column);
      // Nowhere on the disc does a step in the picture turn the direction by more than pi a unit.
      tree.add(map.texels[std::size_t(row / k) * std::size_t(map.size) + std::size_t(column / k)], moments.solid_angle,
               moments.first, std::sqrt(2.0) * std::numbers::pi / size);
    }
  }
  tree.finish();
  return tree;
}

}  // namespace

RadianceMoments radiance_moments(const EnvironmentImage& image) {
  constexpr int chunks = 64;
  const int rows = row_count(image);
  std::array<RadianceMoments, chunks> parts;
  tbb::parallel_for(0, chunks, [&](int chunk) {
    const auto edge = [&](int i) { return int(std::int64_t(rows) * i / chunks); };
    parts[std::size_t(chunk)] = moments_of_rows(image, edge(chunk), edge(chunk + 1));
  });
  RadianceMoments sum;
  for (const RadianceMoments& part : parts) sum += part;
  return sum;
}

IrradianceTree make_irradiance_tree(const EnvironmentImage& image) {
  if (const auto* map = std::get_if<EnvironmentMap>(&image.map)) return latlong_tree(*map);
  if (const auto* cube = std::get_if<CubeMap>(&image.map)) return cube_tree(*cube);
  return angular_tree(std::get<AngularMap>(image.map));
}

IrradianceMap bake_irradiance(const IrradianceTree& tree, int size) {
  const auto edge = std::size_t(size);
  IrradianceMap out{{size, std::vector<Rgb>(6 * edge * edge)}, {0, 0, 0}};
  std::vector<V3d> row_error(6 * edge, V3d(0, 0, 0));
  tbb::parallel_for(0, cube_faces * size, [&](int line) {
    for (int column = 0; column < size; ++column) {
      const V3f n = cube_texel_direction(size, line / size, line % size, column);
      const IrradianceTree::Estimate estimate = tree.irradiance(V3d(n));
      out.e.texels[cube_index(size, line / size, line % size, column)] = Rgb(estimate.e);
      V3d& worst = row_error[std::size_t(line)];
      for (int c = 0; c < 3; ++c) worst[c] = std::max(worst[c], estimate.error[c]);
    }
  });
  for (const V3d& error : row_error)
    for (int c = 0; c < 3; ++c) out.error_bound[c] = std::max(out.error_bound[c], error[c]);
  return out;
}

}  // namespace ivory
