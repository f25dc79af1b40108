// SH9 environments in OpenGL: three matrices as uniforms (shaders/env/sh9.glsl).
#pragma once

#include <cstddef>
#include <string>

#include "grid/io/sh9.h"
#include "runtime/assets/ambient.h"
#include "runtime/gl/gl.h"

namespace ivory {

struct GpuSh9 {
  Sh9MatricesF matrices{};  // E in lux is (n 1) M (n 1)^T; uniforms: there are no OpenGL objects
  float turn_rad = 0;       // of the environment about +Y, against how it was baked; may change from frame to frame
  std::size_t bytes() const { return sizeof(matrices); }
};

// Needs no context and never throws.
GpuSh9 upload(const Sh9& sh);

// Throws Error as read_sh9() does. Needs no context.
GpuSh9 load_sh9(const std::string& path);

// Sets `ivory_sh9` of shaders/ambient/sh9.glsl; makes the program current. Returns first_unit: no texture is taken.
int bind(const GpuSh9& sh, gl::Program& program, int first_unit);

// For the renderer; `sh` must outlive it.
AmbientSource ambient(const GpuSh9& sh);

}  // namespace ivory
