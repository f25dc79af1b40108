// Draws placed meshes under direct lights, each with its own source of ambient light: the rest of the runtime put to
// use. Programs with a renderer of their own take the assets and shaders and leave this.
#pragma once

#include <map>
#include <span>
#include <string>

#include "runtime/assets/ambient.h"
#include "runtime/renderer/material.h"
#include "runtime/renderer/mesh.h"
#include "runtime/renderer/punctual_light.h"

namespace ivory {

// A mesh in its place; all that it points to must outlive the drawing.
struct DrawItem {
  const GpuMesh* mesh = nullptr;
  const SurfaceMaterial* material = nullptr;
  M44f to_world;                           // p_world = p * to_world
  const AmbientSource* ambient = nullptr;  // null: none; a sum_of() any number
  bool direct = true;                      // lit by the frame's lights? Not where its ambient light holds theirs
};

struct RuntimeCamera {
  M44f clip_from_world;     // of row vectors: p_clip = p * clip_from_world
  V3f position_m{0, 0, 0};  // world
  bool perspective = true;
  V3f forward{0, 0, -1};  // unit, world
};
// Cameras as glTF has them, looking along their local -Z. `yfov_rad`: vertical angle of view, in (0, pi);
// `half_height_m`: half of what an orthographic view shows vertically; `aspect`: width over height. Planes in metres
// from the eye, near before far; a perspective's lie in front of it.
RuntimeCamera make_perspective(const M44f& to_world, float yfov_rad, float aspect, float near_m, float far_m);
RuntimeCamera make_orthographic(const M44f& to_world, float half_height_m, float aspect, float near_m, float far_m);

// What one call of Renderer::draw() shows.
struct FrameParams {
  RuntimeCamera camera;
  std::span<const DrawItem> items;
  LightSet* lights = nullptr;  // null: none
  bool direct = true;          // add direct light and emission to the ambient light?
  bool emission = true;        // emission, too? Light adds up: more lights than fit come in a second picture without it
  float exposure = 1;          // factor on all radiance
  // GLSL that holds `#define IVORY_OUTPUT` and vec3 ivory_output(IvorySurface s), which is drawn instead of the
  // reflected radiance; it may call ivory_ambient() and ivory_direct_light(). Empty: none.
  std::string output_shader;
  std::function<int(gl::Program& program, int first_unit)> bind_output;  // its uniforms; may be empty
  const gl::Texture* sky = nullptr;  // lat-long radiance in nits behind everything (shaders/env/sky.glsl)
  float sky_scale = 1;               // factor on it
  float sky_turn_rad = 0;            // about +Y, counter-clockwise seen from above
  Rgb background{0, 0, 0};           // nits, where there is no sky
};

// Keeps the programs that it has compiled, one for each kind of ambient light and output.
class Renderer {
 public:
  // Clears the bound framebuffer, all of it, and draws into the current viewport; needs a depth buffer: linear radiance
  // in nits times the exposure, alpha 1 where anything is. Opaque surfaces are shaded once a pixel (depth first),
  // blended ones from back to front. Leaves depth and scissor test, culling and blending off; takes stencil test,
  // polygon mode, depth range and clip distances to be as OpenGL begins with. Throws Error as IVORY_GL does.
  void draw(const FrameParams& frame);

  // Compiles what the frame needs, which draw() would do the first time.
  void prepare(const FrameParams& frame);

 private:
  gl::Program& program(const FrameParams& frame, const AmbientSource& ambient);
  gl::Program& depth_program();
  void draw_sky(const FrameParams& frame);

  std::map<std::string, gl::Program> programs_;
  gl::VertexArray empty_;
  LightSet no_lights_;
};

}  // namespace ivory
