// Small tables for shaders that pick single entries: a buffer read as samplerBuffer, texelFetch(buffer, i).
#pragma once

#include <span>
#include <string>

#include "runtime/gl/gl.h"

namespace ivory::gl {

struct TexelBuffer {
  Buffer buffer;
  Texture texture;  // RGBA32F; bind() it

  std::size_t bytes() const { return texture.bytes(); }
};

// `what` names the asset in the Error thrown where the context's limits (65536 texels are always there) or its memory
// do not hold it. At least one texel. `changes`: is it written anew every few frames?
TexelBuffer make_texel_buffer(const std::string& what, std::span<const V4f> texels, bool changes = false);

// Replaces all of it, by as many texels or another number.
void write(TexelBuffer& texel_buffer, const std::string& what, std::span<const V4f> texels);

}  // namespace ivory::gl
