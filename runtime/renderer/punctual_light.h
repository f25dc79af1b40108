// Point, spot and directional lights and small pieces of larger ones, with shadow maps.
#pragma once

#include <span>
#include <vector>

#include "grid/base/types.h"
#include "runtime/gl/gl.h"
#include "runtime/renderer/material.h"
#include "runtime/renderer/mesh.h"

namespace ivory {

enum class LightKind { point, spot, directional, patch };

// In the world, as KHR_lights_punctual has them; and a patch, a small piece of an emissive surface. Of many patches,
// each with a shadow map, a lamp with extent is made.
struct RuntimeLight {
  LightKind kind = LightKind::point;
  V3f position_m{0, 0, 0};  // of all but directional
  V3f direction{0, 0, -1};  // spot and directional: unit, the way the light travels; patch: the surface's normal
  Rgb intensity{1, 1, 1};   // cd; directional: illuminance in lux; patch: along its normal, radiance times area
  // Patch: its area in m2, which bounds what it gives nearby. Directional: sr that it stands for. Highlights are as
  // wide as the light is; 0 for a point.
  float extent = 0;
  float inner_angle_rad = 0;  // spot: from the axis, 0 <= inner <= outer <= pi / 2
  float outer_angle_rad = pi / 4;
  bool casts_shadow = true;
};
// In one frame. Point lights and patches take six layers of shadow maps, others one.
inline constexpr std::size_t max_lights = 32;
inline constexpr std::size_t max_shadow_layers = 64;

struct ShadowCaster {
  const GpuMesh* mesh = nullptr;
  M44f to_world;  // p_world = p * to_world
  // A masked or blended surface casts a shadow where it covers at least half; null or opaque: everywhere.
  const SurfaceMaterial* material = nullptr;
};

struct ShadowParams {
  int size = 1024;  // texels a side and layer, 16 to 8192
};

// Depth as the lights see it, in the layers of one texture, and the lights in a uniform buffer.
class LightSet {
 public:
  // Draws the shadow maps: call it again when a light or a caster has moved. Needs a current context. Throws Error for
  // more than max_lights lights, and as IVORY_GL does. Lights for which no layers are left cast no shadow
  // (unshadowed()).
  void update(std::span<const RuntimeLight> lights, std::span<const ShadowCaster> casters,
              const ShadowParams& params = {});

  // Sets what shaders/renderer/punctual_lights.glsl declares, makes the program current, binds one texture to
  // `first_unit` and the uniform buffer to point 0. Returns the next free unit. Only after update().
  int bind(gl::Program& program, int first_unit);

  bool updated() const { return bool(uniforms_); }
  std::size_t bytes() const;                      // of textures and buffers
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
