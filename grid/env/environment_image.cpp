#include "grid/env/environment_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <tbb/parallel_for.h>

#include "grid/env/moments.h"

namespace ivory {

namespace {

constexpr float standing_out = 4;  // times the darkest neighbour

// What both kinds of source are asked for: their texel of a direction, and points of a texel with the solid angles that
// they stand for.
struct CubeSource {
  int size;
  int rows;
  int columns;

  explicit CubeSource(int face_size) : size(face_size), rows(cube_faces * face_size), columns(face_size) {}
  std::size_t texel(const V3f& w) const { return cube_texel(size, w); }
  std::vector<AngularNode> nodes(int row, int column) const {
    constexpr int n = 4;
    std::vector<AngularNode> out;
    const int face = row / size;
    double sum = 0;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const double s = cube_edge(size, column) + 2.0 / size * (i + 0.5) / n;
        const double t = cube_edge(size, row % size) + 2.0 / size * (j + 0.5) / n;
        const V3d point = cube_point(face, s, t);
        const double length = point.length();
        out.push_back({point / length, 1 / (length * length * length)});
        sum += out.back().solid_angle;
      }
    }
    const double scale = cube_texel_solid_angle(size, row % size, column) / sum;
    for (AngularNode& node : out) node.solid_angle *= scale;
    return out;
  }
  double solid_angle(int row, int column) const { return cube_texel_solid_angle(size, row % size, column); }
  // Rows of the same face only.
  bool neighbours(int row, int other) const { return other >= 0 && other < rows && row / size == other / size; }
};

struct AngularSource {
  int size;
  int rows;
  int columns;

  explicit AngularSource(int disc_size) : size(disc_size), rows(disc_size), columns(disc_size) {}
  std::size_t texel(const V3f& w) const { return angular_texel(size, w); }
  std::vector<AngularNode> nodes(int row, int column) const { return angular_nodes(size, row, column); }
  double solid_angle(int row, int column) const { return angular_texel_moments(size, row, column).solid_angle; }
  bool neighbours(int, int other) const { return other >= 0 && other < rows; }
};

// What of each texel does not stand out from its 3 x 3 neighbourhood.
template <typename Source>
std::vector<Rgb> floor_of(const Source& source, const std::vector<Rgb>& texels) {
  std::vector<Rgb> out(texels.size());
  tbb::parallel_for(0, source.rows, [&](int row) {
    for (int column = 0; column < source.columns; ++column) {
      const std::size_t index = std::size_t(row) * std::size_t(source.columns) + std::size_t(column);
      Rgb least = texels[index];
      for (int r = row - 1; r <= row + 1; ++r) {
        if (!source.neighbours(row, r)) continue;
        for (int c = std::max(0, column - 1); c <= std::min(source.columns - 1, column + 1); ++c) {
          const Rgb& other = texels[std::size_t(r) * std::size_t(source.columns) + std::size_t(c)];
          for (unsigned k = 0; k < 3; ++k) least[k] = std::min(least[k], other[k]);
        }
      }
      for (unsigned k = 0; k < 3; ++k) out[index][k] = std::min(texels[index][k], standing_out * least[k]);
    }
  });
  return out;
}

V3f latlong_direction(const EnvironmentMap& map, double row, double column) {
  // Evenly in cos(theta) within a row: equal solid angles.
  const double step = std::numbers::pi / map.height;
  const double whole = std::floor(row);
  const double y = std::cos(whole * step) + (std::cos((whole + 1) * step) - std::cos(whole * step)) * (row - whole);
  const double s = std::sqrt(std::max(0.0, (1 - y) * (1 + y)));
  const double a = 2 * std::numbers::pi * (column / map.width - 0.5);
  return V3f(float(-s * std::sin(a)), float(y), float(s * std::cos(a)));
}

template <typename Source>
EnvironmentMap resampled(const Source& source, const std::vector<Rgb>& texels, int width, int height) {
  EnvironmentMap out{width, height, std::vector<Rgb>(std::size_t(width) * std::size_t(height), Rgb(0, 0, 0))};
  const std::vector<Rgb> base = floor_of(source, texels);
  const int strata = std::clamp(256 / source.columns, 2, 16);
  tbb::parallel_for(0, height, [&](int row) {
    for (int column = 0; column < width; ++column) {
      V3d sum(0, 0, 0);
      for (int j = 0; j < strata; ++j) {
        for (int i = 0; i < strata; ++i) {
          const V3f w = latlong_direction(out, row + (j + 0.5) / strata, column + (i + 0.5) / strata);
          sum += V3d(base[source.texel(w)]);
        }
      }
      out.radiance[std::size_t(row) * std::size_t(width) + std::size_t(column)] = Rgb(sum / (strata * strata));
    }
  });

  const LatLongTexels latlong(width, height);
  V3d gathered(0, 0, 0);
  for (int row = 0; row < height; ++row) {
    const double solid_angle = latlong(row, 0).solid_angle;
    for (int column = 0; column < width; ++column)
      gathered += V3d(out.radiance[std::size_t(row) * std::size_t(width) + std::size_t(column)]) * solid_angle;
  }
  std::vector<double> row_flux(std::size_t(source.rows) * 3);
  tbb::parallel_for(0, source.rows, [&](int row) {
    V3d sum(0, 0, 0);
    for (int column = 0; column < source.columns; ++column) {
      sum += V3d(base[std::size_t(row) * std::size_t(source.columns) + std::size_t(column)]) *
             source.solid_angle(row, column);
    }
    for (unsigned k = 0; k < 3; ++k) row_flux[std::size_t(row) * 3 + k] = sum[k];
  });
  Rgb scale(1, 1, 1);
  for (unsigned k = 0; k < 3; ++k) {
    double flux = 0;
    for (int row = 0; row < source.rows; ++row) flux += row_flux[std::size_t(row) * 3 + k];
    if (gathered[k] > 0) scale[k] = float(flux / gathered[k]);
  }
  for (Rgb& texel : out.radiance) texel *= scale;

  std::vector<double> inverse;
  inverse.reserve(std::size_t(height));
  for (int row = 0; row < height; ++row) inverse.push_back(1 / latlong(row, 0).solid_angle);
  for (int row = 0; row < source.rows; ++row) {
    for (int column = 0; column < source.columns; ++column) {
      const std::size_t index = std::size_t(row) * std::size_t(source.columns) + std::size_t(column);
      const V3d excess = V3d(texels[index]) - V3d(base[index]);
      if (excess == V3d(0, 0, 0)) continue;
      for (const AngularNode& node : source.nodes(row, column)) {
        const double u = 0.5 + std::atan2(-node.w.x, node.w.z) / (2 * std::numbers::pi);
        const double v = std::atan2(std::hypot(node.w.x, node.w.z), node.w.y) / std::numbers::pi;
        const int c = std::clamp(int(u * width), 0, width - 1);
        const int r = std::clamp(int(v * height), 0, height - 1);
        out.radiance[std::size_t(r) * std::size_t(width) + std::size_t(c)] +=
            Rgb(excess * (node.solid_angle * inverse[std::size_t(r)]));
      }
    }
  }
  return out;
}

}  // namespace

EnvironmentMap to_latlong(EnvironmentImage image) {
  if (auto* map = std::get_if<EnvironmentMap>(&image.map)) return std::move(*map);
  if (const auto* cube = std::get_if<CubeMap>(&image.map))
    return resampled(CubeSource(cube->size), cube->texels, 4 * cube->size, 2 * cube->size);
  const auto& disc = std::get<AngularMap>(image.map);
  return resampled(AngularSource(disc.size), disc.texels, 2 * disc.size, disc.size);
}

}  // namespace ivory
