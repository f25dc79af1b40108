// OpenGL objects with owners, and OpenGL errors as exceptions.
//
// Everything of the runtime needs a current OpenGL context, 3.3 core or later, of the caller's making: it opens
// none. Objects must die while the context that made them, or one that shares with it, is current.
// Functions leave bound what they bound last: units' textures without sampler objects, the program,
// GL_PIXEL_UNPACK_BUFFER 0 and rows unpacked without gaps (alignment 1, nothing skipped).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "grid/base/types.h"

namespace ivory::gl {

enum class Kind { texture, buffer, vertex_array, framebuffer, renderbuffer, program, query };

// The name of one OpenGL object, deleted with it. Moves, does not copy; id 0 owns nothing.
template <Kind kind>
class Object {
 public:
  Object() = default;
  explicit Object(std::uint32_t id) : id_(id) {}
  Object(Object&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  Object& operator=(Object&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;
  ~Object();  // in gl.cpp

  std::uint32_t id() const { return id_; }
  explicit operator bool() const { return id_ != 0; }

 private:
  std::uint32_t id_ = 0;
};

using Buffer = Object<Kind::buffer>;
using VertexArray = Object<Kind::vertex_array>;
using Framebuffer = Object<Kind::framebuffer>;
using Renderbuffer = Object<Kind::renderbuffer>;
using Query = Object<Kind::query>;

// A new object of that kind. Throws Error as IVORY_GL does.
template <Kind kind>
Object<kind> make();

// Throws Error where there is no current context, or one older than 3.3; then forgets errors that other code left, so
// that none is laid at ivory's door. upload(), load_*(), make_program() and drawing call it first; the parts they are
// made of (make(), make_texture_*()) do not.
void require_context();

// Throws Error naming `call` where OpenGL has recorded an error since the last check.
void check(const char* call);

enum class Format { r16f, r32f, rgb16f, rgb32f, rgba8, srgb8_alpha8, rgba16f, rgba32f, rgba32ui, depth24 };
std::size_t texel_bytes(Format format);

enum class Filter { nearest, linear, linear_mipmap };
enum class Wrap { clamp, repeat, mirror };

// A texture and what it takes. 1 for sizes that its kind does not have.
struct Texture {
  Object<Kind::texture> object;
  std::uint32_t target = 0;  // GL_TEXTURE_2D, ...
  Format format = Format::rgba8;
  V3i size{0, 0, 0};

  std::size_t bytes() const;  // as asked for: base level of all faces; a driver may pad
};

// Textures with one level, filled from `texels` (rows in order, x fastest; null leaves them undefined): bytes for *8
// formats, floats for all of *f and depth24, rounded to nearest half where stored so, uint32 for *ui. `what`
// names the asset in the Error thrown where the context's limits or its memory do not hold it.
Texture make_texture_2d(const std::string& what, Format format, int width, int height, const void* texels,
                        Filter filter, Wrap wrap_s = Wrap::clamp, Wrap wrap_t = Wrap::clamp);
Texture make_texture_3d(const std::string& what, Format format, const V3i& size, const void* texels, Filter filter);
// `layers` pictures without contents, not blended into each other.
Texture make_texture_array(const std::string& what, Format format, int width, int height, int layers, Filter filter);
// Six square faces in OpenGL's order and orientation, one after another.
Texture make_texture_cube(const std::string& what, Format format, int size, const void* texels, Filter filter);

// Binds to GL_TEXTURE0 + unit, without a sampler object.
void bind(const Texture& texture, int unit);

// A linked program. Uniforms that the compiler found unused are skipped silently, as they have no location.
class Program {
 public:
  Program() = default;
  std::uint32_t id() const { return object_.id(); }
  explicit operator bool() const { return bool(object_); }

  void use() const;
  // Each makes the program current. Names as GLSL has them: "ivory_grid.size", "lights[3].position".
  void set(const std::string& name, int value);
  void set(const std::string& name, float value);
  void set(const std::string& name, const V3f& value);
  void set(const std::string& name, const Rgb& value) { set(name, V3f(value.x, value.y, value.z)); }
  void set(const std::string& name, const V4f& value);
  void set(const std::string& name, const V3i& value);
  // GLSL multiplies column vectors: v' = m * v is what Imath writes v * m.
  void set(const std::string& name, const M33f& value);
  void set(const std::string& name, const M44f& value);
  void set_ivec4(const std::string& name, const std::array<int, 4>& value);
  // Arrays, from element 0.
  void set(const std::string& name, const float* values, int count);
  void set(const std::string& name, const V4f* values, int count);

 private:
  friend Program make_program(const std::string&, std::string_view, std::string_view);
  int location(const std::string& name);

  Object<Kind::program> object_;
  std::map<std::string, int> locations_;
};

// Compiles and links; the sources have neither #version nor resolved includes: both are seen to (with_includes()).
// Throws Error with the compiler's first message; `what` names the program in it.
Program make_program(const std::string& what, std::string_view vertex, std::string_view fragment);

}  // namespace ivory::gl
