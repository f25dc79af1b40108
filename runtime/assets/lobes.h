// Cosine lobes in OpenGL: direct light of spherical lights on Lambertian and glossy surfaces, with soft shadows from
// sphere sets, without noise. shaders/lobes/light.glsl reads them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "grid/lobes/light.h"
#include "runtime/assets/ambient.h"
#include "runtime/gl/texel_buffer.h"

namespace ivory {

// A sphere of even radiance.
struct RuntimeSphereLight {
  Sphere sphere;  // world, m
  Rgb radiance_nits{0, 0, 0};
};

struct GpuLobes {
  gl::Texture integrals;   // R32F 3D: angle x second exponent x first
  gl::Texture products;    // RGB32F 3D, read for glossy surfaces alone
  gl::TexelBuffer blocks;  // of the mask's quad-tree
  gl::TexelBuffer scene;   // lights, groups of spheres, spheres
  int exponent_nodes = 0;  // of the table, along each of its two exponents
  int angle_nodes = 0;
  int lights = 0;
  int groups = 0;  // of neighbouring spheres, each with a bounding sphere
  int spheres = 0;

  std::size_t bytes() const { return integrals.bytes() + products.bytes() + blocks.bytes() + scene.bytes(); }
};

// Needs a current context. Without lights until place(). Throws Error naming `what` where the table's size is wrong or
// the context does not hold it.
GpuLobes upload(const LobeTable& table, const std::string& what = "lobe table");

// read_lobes() and upload(): throws Error as they do, naming the file.
GpuLobes load_lobes(const std::string& path);

// Replaces all lights and all spheres that cast shadows (world, m). Lights hide each other too: leave them out of
// `occluders`. Takes some microseconds and 16 bytes a sphere, so that all may move in every frame. Throws Error where
// the context takes no buffer of two texels a light and 9/8 a sphere (65536 texels always fit).
void place(GpuLobes& lobes, std::span<const RuntimeSphereLight> lights, std::span<const Sphere> occluders);

// Sets the uniforms of shaders/ambient/lobes.glsl, makes the program current and binds four textures from `first_unit`
// on. Returns the next free unit. The depth of masks and the level of splits are compiled into the shader
// (lobe_defines()): of `params` only the rest is read here.
int bind(const GpuLobes& lobes, gl::Program& program, int first_unit, const LobeLightParams& params = {});

// #define lines with the params' mask depth and split level, to stand before #include "ambient/lobes.glsl". Throws
// ParameterError for either outside 0 to 5.
std::string lobe_defines(const LobeLightParams& params);

// For ivory::Renderer: Lambert surfaces, by E; or `glossy`, the material's diffuse and specular reflectance as Lambert
// and Phong lobes. `lobes` must outlive it. Throws ParameterError as lobe_defines() does.
AmbientSource ambient(const GpuLobes& lobes, bool glossy, const LobeLightParams& params = {});

}  // namespace ivory
