// DifMaps in OpenGL: a cube map with seamless linear filtering (shaders/env/difmap.glsl).
#pragma once

#include <cstddef>
#include <string>

#include "grid/env/difmap.h"
#include "runtime/assets/ambient.h"
#include "runtime/gl/gl.h"

namespace ivory {

struct DifMapUploadParams {
  // RGB16F instead of RGB32F: half the memory, E to 2^-11. The scale keeps eleven bits down to 2^-28 of the largest E.
  bool half_floats = false;
};

struct GpuDifMap {
  gl::Texture e;       // E over scale
  float scale = 1;     // lux
  float turn_rad = 0;  // of the environment about +Y, against how it was baked; may change from frame to frame
  std::size_t bytes() const { return e.bytes(); }
};

// Needs a current context. Faces are mirrored into OpenGL's orientation. Throws Error naming `what` where the map is
// larger than the context takes.
GpuDifMap upload(const DifMap& map, const DifMapUploadParams& params = {}, const std::string& what = "DifMap");

// read_difmap() and upload(): throws Error as they do, naming the file.
GpuDifMap load_difmap(const std::string& path, const DifMapUploadParams& params = {});

// Binds the map to `first_unit`, sets the uniforms of shaders/ambient/difmap.glsl and enables
// GL_TEXTURE_CUBE_MAP_SEAMLESS, without which faces' edges show; makes the program current. Returns the next free unit.
int bind(const GpuDifMap& map, gl::Program& program, int first_unit);

// For the renderer; `map` must outlive it.
AmbientSource ambient(const GpuDifMap& map);

}  // namespace ivory
