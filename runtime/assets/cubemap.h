// Localized cube maps on the GPU: light for objects that move near a point. shaders/cubemap/localized.glsl reads them.
#pragma once

#include <string>

#include "grid/cubemap/localized.h"
#include "runtime/assets/ambient.h"
#include "runtime/gl/texel_buffer.h"

namespace ivory {

struct GpuLocalizedCube {
  gl::TexelBuffer texels;  // 36 size^2 + 10 of them, see shaders/cubemap/localized.glsl
  V3f origin_m{0, 0, 0};   // the point that it was baked at
  V3d anchor_m{0, 0, 0};   // shaders are to be given positions less this: grid/base/anchor.h
  int size = 0;            // texels a side of a face
  int steps = 0;           // of the walk over the edges
  Rgb brightest{0, 0, 0};  // nits, of any texel

  std::size_t bytes() const { return texels.bytes(); }
};

// Needs a current context. Throws Error naming `what` where the map is malformed (find_fault()) or larger than the
// context takes: 42 texels a side of a face always fit. A shader's time grows with the square of the side; use 2 to 8.
GpuLocalizedCube upload(const LocalizedCube& cube, const std::string& what = "localized cube map");

// read_localized_cube() and upload(): throws Error as they do, naming the file.
GpuLocalizedCube load_localized_cube(const std::string& path);

// Sets the uniforms of shaders/ambient/cubemap.glsl, makes the program current and binds one texture to `first_unit`.
// Returns the next free unit.
int bind(const GpuLocalizedCube& cube, gl::Program& program, int first_unit);

// For ivory::Renderer; `cube` must outlive it.
AmbientSource ambient(const GpuLocalizedCube& cube, CubeMethod method = CubeMethod::polygon);

}  // namespace ivory
