#include "runtime/gl/gl.h"

#include <fmt/format.h>

#include "grid/base/error.h"
#include "runtime/gl/check.h"

namespace ivory::gl {

namespace {

const char* error_name(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "GL_OUT_OF_MEMORY";
    case GL_CONTEXT_LOST:
      return "GL_CONTEXT_LOST";
    default:
      return "an error of a kind that OpenGL 4.5 does not name";
  }
}

}  // namespace

void check(const char* call) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  throw Error("OpenGL", fmt::format("{} failed with {}", call, error_name(error)),
              error == GL_OUT_OF_MEMORY ? "use smaller or fewer assets"
                                        : "check that the context that made ivory's objects is current");
}

void require_context() {
  // epoxy_gl_version() reads the current context's version; without one glGetString() has nothing to say.
  if (glGetString(GL_VERSION) == nullptr)
    throw Error("OpenGL", "no context is current", "make one of version 3.3 core or later current first");
  const int version = epoxy_gl_version();
  if (!epoxy_is_desktop_gl() || version < 33) {
    throw Error("OpenGL", fmt::format("the current context has version {}.{}", version / 10, version % 10),
                "make one of version 3.3 core or later current");
  }
  // Bounded, because a lost context reports errors for ever.
  for (int i = 0; i < 64 && glGetError() != GL_NO_ERROR; ++i) {
  }
}

template <Kind kind>
Object<kind> make() {
  GLuint id = 0;
  if constexpr (kind == Kind::texture) IVORY_GL(glGenTextures, 1, &id);
  if constexpr (kind == Kind::buffer) IVORY_GL(glGenBuffers, 1, &id);
  if constexpr (kind == Kind::vertex_array) IVORY_GL(glGenVertexArrays, 1, &id);
  if constexpr (kind == Kind::framebuffer) IVORY_GL(glGenFramebuffers, 1, &id);
  if constexpr (kind == Kind::renderbuffer) IVORY_GL(glGenRenderbuffers, 1, &id);
  if constexpr (kind == Kind::query) IVORY_GL(glGenQueries, 1, &id);
  return Object<kind>(id);
}

template <Kind kind>
Object<kind>::~Object() {
  if (id_ == 0) return;
  if constexpr (kind == Kind::texture) glDeleteTextures(1, &id_);
  if constexpr (kind == Kind::buffer) glDeleteBuffers(1, &id_);
  if constexpr (kind == Kind::vertex_array) glDeleteVertexArrays(1, &id_);
  if constexpr (kind == Kind::framebuffer) glDeleteFramebuffers(1, &id_);
  if constexpr (kind == Kind::renderbuffer) glDeleteRenderbuffers(1, &id_);
  if constexpr (kind == Kind::query) glDeleteQueries(1, &id_);
  if constexpr (kind == Kind::program) glDeleteProgram(id_);
}

template Object<Kind::texture> make();
template Object<Kind::buffer> make();
template Object<Kind::vertex_array> make();
template Object<Kind::framebuffer> make();
template Object<Kind::renderbuffer> make();
template Object<Kind::query> make();
template class Object<Kind::texture>;
template class Object<Kind::buffer>;
template class Object<Kind::vertex_array>;
template class Object<Kind::framebuffer>;
template class Object<Kind::renderbuffer>;
template class Object<Kind::query>;
template class Object<Kind::program>;

}  // namespace ivory::gl
