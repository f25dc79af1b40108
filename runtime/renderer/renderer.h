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

struct DrawItem {
  const GpuMesh* mesh = nullptr;
  const SurfaceMaterial* material = nullptr;
  M44f to_world;                           // p_world = p * to_world
  const AmbientSource* ambient = nullptr;  // null: none
};

struct RuntimeCamera {
  M44f clip_from_world;  // of row vectors: p_clip = p * clip_from_world
  V3f position_m{0, 0, 0};
  bool perspective = true;
  V3f forward{0, 0, -1};  // unit; orthographic
};
// A camera as glTF has it: to_world looks along its local -Z; yfov_rad or, orthographic, the half height.
RuntimeCamera make_perspective(const M44f& to_world, float yfov_rad, float aspect, float near_m, float far_m);
RuntimeCamera make_orthographic(const M44f& to_world, float half_height_m, float aspect, float near_m, float far_m);

struct FrameParams {
  RuntimeCamera camera;
  std::span<const DrawItem> items;
  LightSet* lights = nullptr;  // null: none
  bool direct = true;          // add direct light and emission to the ambient light?
  float exposure = 1;          // factor on all radiance
  // GLSL that defines `#define IVORY_OUTPUT` and vec3 ivory_output(IvorySurface s), to show something else than the
  // reflected radiance (ivory_ambient() and ivory_direct_light() are there for it); empty otherwise.
  std::string output_shader;
  std::function<int(gl::Program& program, int first_unit)> bind_output;  // its uniforms; may be empty
  const gl::Texture* sky = nullptr;                                      // lat-long radiance behind everything
  float sky_scale = 1;
  Rgb background{0, 0, 0};  // nits, where there is no sky
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
