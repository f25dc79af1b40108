// Textured lamps for tests: images by a function of the texel, and a quad that wears one.
#pragma once

#include <array>
#include <functional>

#include "tools/stability/scene_builder.h"

namespace ivory {

using Texel = std::array<std::uint8_t, 4>;

inline int add_texture(Scene& scene, int width, int height, const std::function<Texel(int x, int y)>& texel,
                       bool nearest = false, Wrap wrap_s = Wrap::repeat, Wrap wrap_t = Wrap::repeat) {
  Image image;
  image.width = width;
  image.height = height;
  image.rgba.reserve(std::size_t(width) * std::size_t(height) * 4);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Texel t = texel(x, y);
      image.rgba.insert(image.rgba.end(), t.begin(), t.end());
    }
  }
  scene.images.push_back(std::move(image));
  scene.textures.push_back({int(scene.images.size()) - 1, wrap_s, wrap_t, nearest});
  return int(scene.textures.size()) - 1;
}

// One square metre at y = height_m about the y axis that looks down, its texture's columns along x and rows along z.
inline int add_panel(Scene& scene, float height_m, int texture, const Rgb& emission_nits) {
  const int material = add_lambert(scene, Rgb(0, 0, 0), emission_nits);
  scene.materials[std::size_t(material)].emission_texture.texture = texture;
  return add_mesh(scene, make_quad({-0.5F, height_m, -0.5F}, {1, 0, 0}, {0, 0, 1}, material));
}

}  // namespace ivory
