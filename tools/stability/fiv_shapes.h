// Occluders and lights for FIV tables, for sweeps and tests.
#pragma once

#include <cmath>

#include "grid/env/cube_map.h"
#include "tools/stability/scene_builder.h"

namespace ivory {

// Sphere of `rings` times 2 `rings` quads about the origin, fronts outward. Its silhouette is within
// 1 - cos(pi / (2 rings)) of the circle.
inline Mesh make_ball(float radius, int rings, int material) {
  Mesh mesh;
  const int around = 2 * rings;
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j < around; ++j) {
      const float theta = pi * float(i) / float(rings);
      const float phi = 2 * pi * float(j) / float(around);
      mesh.positions.push_back(V3f(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)) *
                               radius);
    }
  }
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      const auto a = std::uint32_t(i * around + j);
      const auto b = std::uint32_t(i * around + (j + 1) % around);
      const auto down = std::uint32_t(around);
      if (i > 0) mesh.triangles.push_back({a, b, a + down});
      if (i + 1 < rings) mesh.triangles.push_back({b, b + down, a + down});
    }
  }
  mesh.material = material;
  return mesh;
}

inline Scene ball_scene(float radius = 1, const V3f& center = V3f(0, 0, 0), int rings = 32) {
  Scene scene;
  scene.name = "ball";
  const int white = add_lambert(scene, Rgb(0.7F, 0.7F, 0.7F));
  M44f place;
  place.setTranslation(center);
  add_mesh(scene, make_ball(radius, rings, white), place);
  return scene;
}

// A long bent thing without symmetry: three boxes, fronts outward unless `inside_out`.
inline Scene bracket_scene(const M44f& place = M44f(), bool inside_out = false) {
  Scene scene;
  scene.name = "bracket";
  const int white = add_lambert(scene, Rgb(0.7F, 0.7F, 0.7F));
  const V3f corners[3][2] = {{{-1, -0.2F, -0.2F}, {1, 0.2F, 0.2F}},
                             {{0.6F, 0.2F, -0.2F}, {1, 0.9F, 0.2F}},
                             {{-1, -0.2F, 0.2F}, {-0.6F, 0.2F, 0.7F}}};
  for (const auto& box : corners) {
    Mesh mesh = make_room(box[0], box[1], white);  // its fronts look inward
    if (!inside_out) {
      for (auto& t : mesh.triangles) std::swap(t.y, t.z);
    }
    add_mesh(scene, std::move(mesh), place);
  }
  return scene;
}

inline CubeMap uniform_cube(const Rgb& radiance, int size) {
  return {size, std::vector<Rgb>(std::size_t(6) * std::size_t(size) * std::size_t(size), radiance)};
}

// Smooth, coloured, different along every axis.
inline CubeMap coloured_cube(int size) {
  CubeMap map{size, {}};
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const V3f w = cube_texel_direction(size, face, row, column);
        map.texels.emplace_back(1 + 0.9F * w.x, 1.2F + w.y, 0.8F + 0.5F * w.z * w.z);
      }
    }
  }
  return map;
}

}  // namespace ivory
