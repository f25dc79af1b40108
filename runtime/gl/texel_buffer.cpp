#include "runtime/gl/texel_buffer.h"

#include <cassert>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "runtime/gl/check.h"

namespace ivory::gl {

namespace {

void require_size(const std::string& what, std::size_t texels) {
  assert(texels > 0);
  GLint limit = 0;
  IVORY_GL(glGetIntegerv, GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
  if (texels <= std::size_t(limit)) return;
  throw Error(what, fmt::format("needs a table of {} entries, and this OpenGL takes {}", texels, limit),
              "make it smaller");
}

void fill(const TexelBuffer& texel_buffer, const std::string& what, std::span<const V4f> texels, GLenum usage) {
  IVORY_GL(glBindBuffer, GL_TEXTURE_BUFFER, texel_buffer.buffer.id());
  glBufferData(GL_TEXTURE_BUFFER, GLsizeiptr(texels.size_bytes()), texels.data(), usage);
  const GLenum error = glGetError();
  IVORY_GL(glBindBuffer, GL_TEXTURE_BUFFER, 0);
  if (error == GL_OUT_OF_MEMORY)
    throw Error(what, fmt::format("glBufferData found no memory for {} bytes", texels.size_bytes()), "make it smaller");
  if (error != GL_NO_ERROR)
    throw Error(what, fmt::format("glBufferData failed with OpenGL error 0x{:x}", error), "check the context");
}

}  // namespace

TexelBuffer make_texel_buffer(const std::string& what, std::span<const V4f> texels, bool changes) {
  require_size(what, texels.size());
  TexelBuffer result;
  result.buffer = make<Kind::buffer>();
  fill(result, what, texels, changes ? GL_DYNAMIC_DRAW : GL_STATIC_DRAW);
  Texture& texture = result.texture;
  texture.object = make<Kind::texture>();
  texture.target = GL_TEXTURE_BUFFER;
  texture.format = Format::rgba32f;
  texture.size = {int(texels.size()), 1, 1};
  IVORY_GL(glBindTexture, GL_TEXTURE_BUFFER, texture.object.id());
  IVORY_GL(glTexBuffer, GL_TEXTURE_BUFFER, GL_RGBA32F, result.buffer.id());
  return result;
}

void write(TexelBuffer& texel_buffer, const std::string& what, std::span<const V4f> texels) {
  require_size(what, texels.size());
  fill(texel_buffer, what, texels, GL_DYNAMIC_DRAW);
  texel_buffer.texture.size.x = int(texels.size());
}

}  // namespace ivory::gl
