// Localized cube maps on the GPU: light for objects that move near a point. shaders/cubemap/localized.glsl reads them.
#pragma once

#include <string>

#include "grid/cubemap/localized.h"
#include "runtime/assets/ambient.h"
#include "runtime/gl/texel_buffer.h"

namespace ivory {

struct GpuLocalizedCube {
  gl::TexelBuffer texels;  // 36 size^2 + 10 of them, see shaders/cubemap/localized.glsl
  V3f origin_m{0, 0, 0};
  int size = 0;
  int steps = 0;
  Rgb brightest{0, 0, 0};

  std::size_t bytes() const { return texels.bytes(); }
};

// Needs a current context. Throws Error where `cube` is none (find_fault()) or is larger than the context takes: 42
// texels a side of a face at OpenGL's least; a shader's time grows with its square, so that 2 to 8 are for use.
GpuLocalizedCube upload(const LocalizedCube& cube, const std::string& what = "localized cube map");

// read_localized_cube() and upload(); throws Error for what is no cube map and leaves no object behind.
GpuLocalizedCube load_localized_cube(const std::string& path);

// Sets ivory_cubemap and ivory_cubemap_texels of shaders/ambient/cubemap.glsl. Takes one unit; returns the next.
int bind(const GpuLocalizedCube& cube, gl::Program& program, int first_unit);

// For ivory::Renderer; `cube` must outlive it.
AmbientSource ambient(const GpuLocalizedCube& cube, CubeMethod method = CubeMethod::polygon);

}  // namespace ivory
