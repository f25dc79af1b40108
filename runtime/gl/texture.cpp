#include <algorithm>
#include <cassert>
#include <vector>

#include <fmt/format.h>
#include <half.h>

#include "grid/base/error.h"
#include "runtime/gl/check.h"

namespace ivory::gl {

namespace {

struct Layout {
  GLenum internal_format;
  GLenum format;  // of what is handed over
  GLenum type;
  std::size_t bytes;  // a stored texel
};

Layout layout(Format format) {
  switch (format) {
    case Format::r16f:
      return {GL_R16F, GL_RED, GL_FLOAT, 2};
    case Format::r32f:
      return {GL_R32F, GL_RED, GL_FLOAT, 4};
    case Format::rgb16f:
      return {GL_RGB16F, GL_RGB, GL_FLOAT, 6};
    case Format::rgb32f:
      return {GL_RGB32F, GL_RGB, GL_FLOAT, 12};
    case Format::rgba8:
      return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4};
    case Format::srgb8_alpha8:
      return {GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, 4};
    case Format::rgba16f:
      return {GL_RGBA16F, GL_RGBA, GL_FLOAT, 8};
    case Format::rgba32f:
      return {GL_RGBA32F, GL_RGBA, GL_FLOAT, 16};
    case Format::rgba32ui:
      return {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 16};
    case Format::depth24:
      return {GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_FLOAT, 4};
  }
  assert(false);
  return {};
}

void require_size(const std::string& what, GLenum limit_name, int largest) {
  GLint limit = 0;
  IVORY_GL(glGetIntegerv, limit_name, &limit);
  if (largest > limit) {
    throw Error(what, fmt::format("needs a texture of {} texels a side, and this OpenGL takes {}", largest, limit),
                "bake it coarser");
  }
}

// What OpenGL is handed over: floats go to halves here, rounded to nearest, as drivers differ (llvmpipe cuts off).
struct Texels {
  std::vector<half> halves;
  const void* data = nullptr;
  GLenum type = GL_FLOAT;
};

Texels texels_for(Format format, const void* texels, std::size_t count) {
  const Layout l = layout(format);
  Texels out{{}, texels, l.type};
  std::size_t channels = 0;
  if (format == Format::r16f) channels = 1;
  if (format == Format::rgb16f) channels = 3;
  if (format == Format::rgba16f) channels = 4;
  if (channels == 0 || texels == nullptr) return out;
  const auto* floats = static_cast<const float*>(texels);
  out.halves.assign(floats, floats + count * channels);
  out.data = out.halves.data();
  out.type = GL_HALF_FLOAT;
  return out;
}

// glGetError() after an upload tells of memory that ran out, in the asset's name.
void check_memory(const std::string& what, const char* call, std::size_t bytes) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  if (error == GL_OUT_OF_MEMORY) {
    throw Error(what, fmt::format("{} found no memory for its {} MiB", call, bytes >> 20U),
                "bake it coarser, or free other textures");
  }
  throw Error(what, fmt::format("{} failed with OpenGL error 0x{:x}", call, error), "check the context");
}

Texture begin(Format format, GLenum target, const V3i& size) {
  Texture texture;
  texture.object = make<Kind::texture>();
  texture.target = target;
  texture.format = format;
  texture.size = size;
  IVORY_GL(glBindTexture, target, texture.object.id());
  // Rows are handed over without gaps, from memory.
  IVORY_GL(glBindBuffer, GL_PIXEL_UNPACK_BUFFER, 0);
  IVORY_GL(glPixelStorei, GL_UNPACK_ALIGNMENT, 1);
  IVORY_GL(glPixelStorei, GL_UNPACK_ROW_LENGTH, 0);
  IVORY_GL(glPixelStorei, GL_UNPACK_IMAGE_HEIGHT, 0);
  for (const GLenum skipped : {GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_IMAGES, GL_UNPACK_SWAP_BYTES})
    IVORY_GL(glPixelStorei, skipped, 0);
  return texture;
}

GLint edge_mode(Wrap wrap) {
  return wrap == Wrap::clamp ? GL_CLAMP_TO_EDGE : wrap == Wrap::repeat ? GL_REPEAT : GL_MIRRORED_REPEAT;
}

void set_sampling(const Texture& texture, Filter filter, Wrap wrap_s = Wrap::clamp, Wrap wrap_t = Wrap::clamp) {
  const GLint magnify = filter == Filter::nearest ? GL_NEAREST : GL_LINEAR;
  const GLint minify = filter == Filter::linear_mipmap ? GL_LINEAR_MIPMAP_LINEAR : magnify;
  IVORY_GL(glTexParameteri, texture.target, GL_TEXTURE_MAG_FILTER, magnify);
  IVORY_GL(glTexParameteri, texture.target, GL_TEXTURE_MIN_FILTER, minify);
  IVORY_GL(glTexParameteri, texture.target, GL_TEXTURE_WRAP_S, edge_mode(wrap_s));
  IVORY_GL(glTexParameteri, texture.target, GL_TEXTURE_WRAP_T, edge_mode(wrap_t));
  IVORY_GL(glTexParameteri, texture.target, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
  if (filter == Filter::linear_mipmap) {
    IVORY_GL(glGenerateMipmap, texture.target);
  } else {
    IVORY_GL(glTexParameteri, texture.target, GL_TEXTURE_MAX_LEVEL, 0);
  }
}

}  // namespace

std::size_t texel_bytes(Format format) { return layout(format).bytes; }

std::size_t Texture::bytes() const {
  const std::size_t faces = target == GL_TEXTURE_CUBE_MAP ? 6 : 1;
  return texel_bytes(format) * faces * std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z);
}

Texture make_texture_2d(const std::string& what, Format format, int width, int height, const void* texels,
                        Filter filter, Wrap wrap_s, Wrap wrap_t) {
  require_size(what, GL_MAX_TEXTURE_SIZE, std::max(width, height));
  Texture texture = begin(format, GL_TEXTURE_2D, {width, height, 1});
  const Layout l = layout(format);
  const Texels t = texels_for(format, texels, std::size_t(width) * std::size_t(height));
  glTexImage2D(texture.target, 0, GLint(l.internal_format), width, height, 0, l.format, t.type, t.data);
  check_memory(what, "glTexImage2D", texture.bytes());
  set_sampling(texture, filter, wrap_s, wrap_t);
  return texture;
}

Texture make_texture_3d(const std::string& what, Format format, const V3i& size, const void* texels, Filter filter) {
  require_size(what, GL_MAX_3D_TEXTURE_SIZE, std::max({size.x, size.y, size.z}));
  Texture texture = begin(format, GL_TEXTURE_3D, size);
  const Layout l = layout(format);
  const Texels t = texels_for(format, texels, std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z));
  glTexImage3D(texture.target, 0, GLint(l.internal_format), size.x, size.y, size.z, 0, l.format, t.type, t.data);
  check_memory(what, "glTexImage3D", texture.bytes());
  set_sampling(texture, filter);
  return texture;
}

Texture make_texture_array(const std::string& what, Format format, int width, int height, int layers, Filter filter) {
  require_size(what, GL_MAX_TEXTURE_SIZE, std::max(width, height));
  require_size(what, GL_MAX_ARRAY_TEXTURE_LAYERS, layers);
  Texture texture = begin(format, GL_TEXTURE_2D_ARRAY, {width, height, layers});
  const Layout l = layout(format);
  glTexImage3D(texture.target, 0, GLint(l.internal_format), width, height, layers, 0, l.format, l.type, nullptr);
  check_memory(what, "glTexImage3D", texture.bytes());
  set_sampling(texture, filter);
  return texture;
}

Texture make_texture_cube(const std::string& what, Format format, int size, const void* texels, Filter filter) {
  require_size(what, GL_MAX_CUBE_MAP_TEXTURE_SIZE, size);
  Texture texture = begin(format, GL_TEXTURE_CUBE_MAP, {size, size, 1});
  const Layout l = layout(format);
  const std::size_t face = std::size_t(size) * std::size_t(size);
  const Texels t = texels_for(format, texels, 6 * face);
  const std::size_t channels = l.format == GL_RED ? 1 : l.format == GL_RG ? 2 : l.format == GL_RGB ? 3 : 4;
  const std::size_t face_bytes = (t.type == GL_UNSIGNED_BYTE ? 1 : t.type == GL_HALF_FLOAT ? 2 : 4) * channels * face;
  for (unsigned i = 0; i < 6; ++i) {
    const auto* from = static_cast<const std::byte*>(t.data);
    glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + i, 0, GLint(l.internal_format), size, size, 0, l.format, t.type,
                 from == nullptr ? nullptr : from + i * face_bytes);
    check_memory(what, "glTexImage2D", texture.bytes());
  }
  set_sampling(texture, filter);
  return texture;
}

void bind(const Texture& texture, int unit) {
  IVORY_GL(glActiveTexture, GLenum(GL_TEXTURE0 + unit));
  IVORY_GL(glBindTexture, texture.target, texture.object.id());
  // A sampler object of the host's would override the texture's own filter.
  IVORY_GL(glBindSampler, GLuint(unit), 0);
}

}  // namespace ivory::gl
