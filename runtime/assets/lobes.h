// Cosine lobes on the GPU: direct light of balls on matt and glossy surfaces with soft shadows from sphere sets,
// without noise. shaders/lobes/light.glsl reads them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "grid/lobes/light.h"
#include "runtime/assets/ambient.h"
#include "runtime/gl/texel_buffer.h"

namespace ivory {

// A light: a ball of even radiance.
struct BallLight {
  Sphere ball;
  Rgb radiance_nits{0, 0, 0};
};

struct GpuLobes {
  gl::Texture integrals;   // R32F 3D: angle x second exponent x first
  gl::Texture products;    // RGB32F 3D, read for glossy surfaces alone
  gl::TexelBuffer blocks;  // of the mask's quad-tree
  gl::TexelBuffer scene;   // lights and occluders
  int exponent_nodes = 0;
  int angle_nodes = 0;
  int lights = 0;
  int groups = 0;
  int spheres = 0;

  std::size_t bytes() const { return integrals.bytes() + products.bytes() + blocks.bytes() + scene.bytes(); }
};

// Needs a current context. Without lights until place(). Throws Error where the context does not hold the table.
GpuLobes upload(const LobeTable& table, const std::string& what = "lobe table");

// read_lobes() and upload(); throws Error for what is no lobe table and leaves no object behind.
GpuLobes load_lobes(const std::string& path);

// Replaces lights and occluders (world, m), which the lights need not be among: they hide each other. Cheap: some
// microseconds and 16 bytes a sphere, so that all may move in every frame. Throws Error where the context takes no
// buffer of two texels a light and 9/8 a sphere (65536 always fit).
void place(GpuLobes& lobes, std::span<const BallLight> lights, std::span<const Sphere> occluders);

// Sets the uniforms and samplers of shaders/ambient/lobes.glsl; takes four units, returns the next. The depth of masks
// and the level of splits are the shader's own, by #define (lobe_defines()); of `params` only the rest counts.
int bind(const GpuLobes& lobes, gl::Program& program, int first_unit, const LobeLightParams& params = {});

// #define lines that give shaders the params' mask depth and split level.
std::string lobe_defines(const LobeLightParams& params);

// For ivory::Renderer: Lambert surfaces, by E; or `glossy`, the material's diffuse and specular reflectance as Lambert
// and Phong lobes, as ivory render --method lobes does. `lobes` must outlive it. Throws UsageError for params out of
// range.
AmbientSource ambient(const GpuLobes& lobes, bool glossy, const LobeLightParams& params = {});

}  // namespace ivory
