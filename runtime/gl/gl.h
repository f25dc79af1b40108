// OpenGL objects with owners, and OpenGL errors as exceptions.
//
// Everything of the runtime needs a current OpenGL context, 3.3 core or later, which the caller makes. Objects must be
// destroyed while the context that made them, or one that shares with it, is current. Functions leave bound what they
// bound last: textures of units without sampler objects, the program, GL_PIXEL_UNPACK_BUFFER 0 and rows unpacked
// without gaps (alignment 1, nothing skipped).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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
  // No longer owned: the id is the caller's.
  std::uint32_t release() { return std::exchange(id_, 0); }

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

// Throws Error where there is no current context, or one older than 3.3. Then clears the errors that other code left,
// so that ivory does not report them as its own. upload(), load_*(), make_program() and drawing call it first; the
// parts that they are made of (make(), make_texture_*()) do not.
void require_context();

// Throws Error naming `call` where OpenGL has recorded an error since the last check.
void check(const char* call);

// Of texels, by OpenGL's names.
enum class Format { r16f, r32f, rgb16f, rgb32f, rgba8, srgb8_alpha8, rgba16f, rgba32f, rgba32ui, depth24 };
std::size_t texel_bytes(Format format);  // of a stored texel

enum class Filter { nearest, linear, linear_mipmap };
enum class Wrap { clamp, repeat, mirror };

struct Texture {
  Object<Kind::texture> object;
  std::uint32_t target = 0;  // GL_TEXTURE_2D, ...
  Format format = Format::rgba8;
  V3i size{0, 0, 0};  // texels; z is the layers of an array; 1 along axes that the target does not have

  std::size_t bytes() const;  // as asked for: base level of all faces; a driver may pad
};

// Textures filled from `texels`, rows in order, x fastest; null leaves them undefined. They are bytes for *8 formats,
// uint32 for *ui, floats for all others (rounded to the nearest half where stored so), as many a texel as the format
// has channels. One level, but for Filter::linear_mipmap, which makes all. `what` names the asset in the Error thrown
// where the context's limits or its memory do not hold it.
Texture make_texture_2d(const std::string& what, Format format, int width, int height, const void* texels,
                        Filter filter, Wrap wrap_s = Wrap::clamp, Wrap wrap_t = Wrap::clamp);
Texture make_texture_3d(const std::string& what, Format format, const V3i& size, const void* texels, Filter filter);
// `layers` pictures without contents, not blended into each other.
Texture make_texture_array(const std::string& what, Format format, int width, int height, int layers, Filter filter);
// Six square faces in OpenGL's order and orientation, one after another.
Texture make_texture_cube(const std::string& what, Format format, int size, const void* texels, Filter filter);

// Binds to GL_TEXTURE0 + unit, without a sampler object. Throws Error as IVORY_GL does.
void bind(const Texture& texture, int unit);

// A linked program. Uniforms that the compiler found unused are skipped silently, as they have no location.
class Program {
 public:
  Program() = default;
  std::uint32_t id() const { return object_.id(); }
  explicit operator bool() const { return bool(object_); }

  void use() const;  // makes it current
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
  // A uniform block; `binding` is the point that its buffer is bound to, but in a slot, which takes one of its own.
  void bind_block(const std::string& name, const Buffer& buffer, int binding);

  // While it lives, names are those within that slot of the source (with_includes()): what binds an asset does not
  // know that there are others of its kind. Nests.
  class Slot {
   public:
    Slot(Program& program, int slot) : slots_(program.slots_) { slots_.push_back(slot); }
    Slot(const Slot&) = delete;
    Slot& operator=(const Slot&) = delete;
    ~Slot() { slots_.pop_back(); }

   private:
    std::vector<int>& slots_;
  };

 private:
  friend Program make_program(const std::string&, std::string_view, std::string_view);
  friend class BorrowedProgram;
  int location(const std::string& name);
  std::string full_name(const std::string& name) const;

  Object<Kind::program> object_;
  std::vector<int> slots_;  // the outermost first
  std::map<std::string, int> locations_;
};

// Another's linked program, for as long as this lives; it is not deleted. Knows no location yet, as the program may
// have been linked anew since the last time.
class BorrowedProgram {
 public:
  explicit BorrowedProgram(std::uint32_t id) { program_.object_ = Object<Kind::program>(id); }
  BorrowedProgram(const BorrowedProgram&) = delete;
  BorrowedProgram& operator=(const BorrowedProgram&) = delete;
  ~BorrowedProgram() { program_.object_.release(); }
  Program& program() { return program_; }

 private:
  Program program_;
};

// Compiles and links GLSL 3.30: adds the #version line to both sources and resolves their #include lines
// (with_includes()). Needs a current context. Throws Error with the compiler's first message; `what` names the program
// in it.
Program make_program(const std::string& what, std::string_view vertex, std::string_view fragment);

}  // namespace ivory::gl
