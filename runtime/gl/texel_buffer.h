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

// Needs a current context and at least one texel. Throws Error naming `what` where the context's limits (65536 texels
// always fit) or its memory do not hold it. `changes`: is it written anew every few frames?
TexelBuffer make_texel_buffer(const std::string& what, std::span<const V4f> texels, bool changes = false);

// Replaces all of it, by as many texels or another number, at least one. Throws as make_texel_buffer() does.
void write(TexelBuffer& texel_buffer, const std::string& what, std::span<const V4f> texels);

}  // namespace ivory::gl
