// Point, spot and directional lights, with shadow maps.
#pragma once

#include <span>
#include <vector>

#include "grid/base/types.h"
#include "runtime/gl/gl.h"
#include "runtime/renderer/material.h"
#include "runtime/renderer/mesh.h"

namespace ivory {

enum class LightKind { point, spot, directional };

struct RuntimeLight {
  LightKind kind = LightKind::point;
  V3f position_m{0, 0, 0};
  V3f direction{0, 0, -1};    // unit, the way the light travels
  Rgb intensity{1, 1, 1};     // cd; directional: lux
  float inner_angle_rad = 0;  // spot
  float outer_angle_rad = pi / 4;
  bool casts_shadow = true;
};
inline constexpr std::size_t max_lights = 32;
inline constexpr std::size_t max_shadow_layers = 64;  // a point light takes six, others one

struct ShadowCaster {
  const GpuMesh* mesh = nullptr;
  M44f to_world;
  // Of a masked or blended surface, which casts a shadow where it covers at least half; null or opaque: everywhere.
  const SurfaceMaterial* material = nullptr;
};

struct ShadowParams {
  int size = 1024;  // texels a side and layer, 16 to 8192
};

// Depth as the lights see it, in the layers of one texture, and the lights in a uniform buffer.
class LightSet {
 public:
  // Draws the shadow maps: to be called again when a light or a caster has moved. Throws Error for more lights than
  // max_lights; lights for which there are no layers left cast no shadow (see unshadowed()).
  void update(std::span<const RuntimeLight> lights, std::span<const ShadowCaster> casters,
              const ShadowParams& params = {});

  // Binds for shaders/renderer/punctual_lights.glsl; returns the next free texture unit. Only after update().
  int bind(gl::Program& program, int first_unit);

  bool updated() const { return bool(uniforms_); }
  std::size_t bytes() const;
  int unshadowed() const { return unshadowed_; }  // lights that should cast shadows and do not

 private:
  void make_objects(int size, int layers);

  void draw_depth(const ShadowCaster& caster, const M44f& clip_from_world);

  gl::Program depth_program_;
  gl::Program masked_program_;
  gl::Texture depth_;
  gl::Framebuffer framebuffer_;
  gl::Buffer uniforms_;
  int unshadowed_ = 0;
};

}  // namespace ivory
