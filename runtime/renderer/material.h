// How a surface reflects: glTF's metallic-roughness model, or specular-glossiness.
#pragma once

#include <array>

#include "grid/base/types.h"
#include "runtime/gl/gl.h"

namespace ivory {

// A texture and where it lies: u' = m[0] u + m[1] v + m[2], v' = m[3] u + m[4] v + m[5] of that uv set, with m its
// uv_transform.
struct MaterialTexture {
  const gl::Texture* texture = nullptr;  // null: none; must outlive the drawing
  int uv_set = 0;                        // 0 or 1
  std::array<float, 6> uv_transform{1, 0, 0, 0, 1, 0};
};

// What alpha does: nothing; cuts off below alpha_cutoff; mixes with what lies behind.
enum class Coverage { opaque, mask, blend };

struct SurfaceMaterial {
  Rgb base_color{1, 1, 1};
  float alpha = 1;
  MaterialTexture base_color_texture;  // sRGB colour, linear alpha
  Coverage coverage = Coverage::opaque;
  float alpha_cutoff = 0.5F;
  bool double_sided = false;

  // Metallic-roughness: reflectance of the dielectric part at normal and at grazing incidence; 0 and 0 is Lambert
  // alone.
  float metallic = 0;
  float roughness = 1;
  Rgb dielectric_f0{0.04F, 0.04F, 0.04F};
  float dielectric_f90 = 1;
  // Specular-glossiness instead, with dielectric_f0 as its specular colour and 1 - roughness as its glossiness.
  bool specular_glossiness = false;
  MaterialTexture surface_texture;  // linear G roughness, B metallic; or sRGB specular colour, linear A glossiness

  MaterialTexture normal_texture;  // linear, tangent space
  float normal_scale = 1;

  Rgb emission{0, 0, 0};             // nits
  MaterialTexture emission_texture;  // sRGB
};

// Sets the material's uniforms of shaders/renderer/surface.glsl, makes the program current, binds textures to
// `first_unit` and the three behind it, and returns the unit after those.
int bind(const SurfaceMaterial& material, gl::Program& program, int first_unit);

}  // namespace ivory
