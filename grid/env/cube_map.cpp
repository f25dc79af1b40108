#include "grid/env/cube_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace ivory {

namespace {

// A neighbour's texel centre as a point of the cube, for i or j one step outside the face.
V3d beyond_edge(int size, const CubeFaceAxes& axes, int row, int column) {
  const auto centre = [size](int i) { return (2 * i + 1 - size) / double(size); };
  double s = centre(column);
  double t = centre(row);
  double depth = 1;
  // The neighbour lies folded back behind the edge: its outermost centre is half a texel down.
  if (std::abs(s) > 1 || std::abs(t) > 1) depth -= 1.0 / size;
  s = std::clamp(s, -1.0, 1.0);
  t = std::clamp(t, -1.0, 1.0);
  return V3d(axes.forward) * depth + V3d(axes.right) * s + V3d(axes.down) * t;
}

int texel_at(int size, float position) { return std::clamp(int((position + 1) * 0.5F * float(size)), 0, size - 1); }

}  // namespace

const CubeFaceAxes& cube_face_axes(int face) {
  static const std::array<CubeFaceAxes, cube_faces> axes{{
      {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
      {{-1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
      {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
      {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
      {{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}},
      {{0, 0, -1}, {1, 0, 0}, {0, -1, 0}},
  }};
  assert(face >= 0 && face < cube_faces);
  return axes[std::size_t(face)];
}

V3d cube_point(int face, double s, double t) {
  const CubeFaceAxes& axes = cube_face_axes(face);
  return V3d(axes.forward) + V3d(axes.right) * s + V3d(axes.down) * t;
}

CubePosition cube_position(const V3f& w) {
  const V3f a(std::abs(w.x), std::abs(w.y), std::abs(w.z));
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : (a.y >= a.z ? 1 : 2);
  const float depth = a[unsigned(axis)];
  if (!(depth > 0)) return {};
  const int face = 2 * axis + (w[unsigned(axis)] < 0 ? 1 : 0);
  const CubeFaceAxes& axes = cube_face_axes(face);
  return {face, w.dot(axes.right) / depth, w.dot(axes.down) / depth};
}

V3f cube_texel_direction(int size, int face, int row, int column) {
  const double s = (2 * column + 1 - size) / double(size);
  const double t = (2 * row + 1 - size) / double(size);
  return V3f(cube_point(face, s, t).normalized());
}

std::size_t cube_texel(int size, const V3f& w) {
  const CubePosition p = cube_position(w);
  return cube_index(size, p.face, texel_at(size, p.t), texel_at(size, p.s));
}

// The rectangle [0, s] x [0, t] of the plane at distance one covers atan(s t / sqrt(1 + s^2 + t^2)): its mixed
// derivative is (1 + s^2 + t^2)^(-3/2), the solid angle of an area element there.
double cube_texel_solid_angle(int size, int row, int column) {
  const auto corner = [](double s, double t) { return std::atan2(s * t, std::sqrt(1 + s * s + t * t)); };
  const double s0 = cube_edge(size, column);
  const double s1 = cube_edge(size, column + 1);
  const double t0 = cube_edge(size, row);
  const double t1 = cube_edge(size, row + 1);
  return corner(s1, t1) - corner(s0, t1) - corner(s1, t0) + corner(s0, t0);
}

CubeTaps cube_taps(int size, const V3f& w) {
  const CubePosition p = cube_position(w);
  const CubeFaceAxes& axes = cube_face_axes(p.face);
  // In texels, whole numbers at texel centres.
  const float x = (p.s + 1) * 0.5F * float(size) - 0.5F;
  const float y = (p.t + 1) * 0.5F * float(size) - 0.5F;
  const int column = std::clamp(int(std::floor(x)), -1, size - 1);
  const int row = std::clamp(int(std::floor(y)), -1, size - 1);
  const float fx = std::clamp(x - float(column), 0.0F, 1.0F);
  const float fy = std::clamp(y - float(row), 0.0F, 1.0F);

  CubeTaps taps{};
  taps.weight = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
  int missing = -1;
  for (int i = 0; i < 4; ++i) {
    const int r = row + i / 2;
    const int c = column + i % 2;
    const bool beside = c < 0 || c >= size;
    const bool above = r < 0 || r >= size;
    if (!beside && !above) {
      taps.texel[std::size_t(i)] = cube_index(size, p.face, r, c);
    } else if (beside && above) {
      missing = i;
    } else {
      taps.texel[std::size_t(i)] = cube_texel(size, V3f(beyond_edge(size, axes, r, c)));
    }
  }
  if (missing >= 0) {
    const float share = taps.weight[std::size_t(missing)] / 3;
    for (int i = 0; i < 4; ++i) taps.weight[std::size_t(i)] += share;
    taps.weight[std::size_t(missing)] = 0;
    taps.texel[std::size_t(missing)] = taps.texel[std::size_t(missing ^ 1)];
  }
  return taps;
}

Rgb bilinear(const CubeMap& map, const V3f& w) {
  assert(map.size > 0 && map.texels.size() == std::size_t(6) * std::size_t(map.size) * std::size_t(map.size));
  const CubeTaps taps = cube_taps(map.size, w);
  Rgb sum(0, 0, 0);
  for (std::size_t i = 0; i < 4; ++i) sum += map.texels[taps.texel[i]] * taps.weight[i];
  return sum;
}

}  // namespace ivory
