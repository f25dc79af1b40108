#include <string>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "runtime/gl/check.h"
#include "runtime/gl/shader_source.h"

namespace ivory::gl {

namespace {

class Shader {
 public:
  explicit Shader(GLenum kind) : id_(glCreateShader(kind)) { check("glCreateShader"); }
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  ~Shader() { glDeleteShader(id_); }
  GLuint id() const { return id_; }

 private:
  GLuint id_;
};

// A log is many lines and ends in a zero; the first line tells what is wrong first.
std::string first_line(const std::string& log) {
  const std::string line = log.substr(0, log.find_first_of(std::string("\n\0", 2)));
  return line.empty() ? "without a message" : line;
}

void compile(const std::string& what, const Shader& shader, std::string_view source) {
  const std::string text = "#version 330 core\n#line 1 0\n" + with_includes(source);
  const char* pointer = text.c_str();
  IVORY_GL(glShaderSource, shader.id(), 1, &pointer, nullptr);
  IVORY_GL(glCompileShader, shader.id());
  GLint good = GL_FALSE;
  glGetShaderiv(shader.id(), GL_COMPILE_STATUS, &good);
  if (good == GL_TRUE) return;
  GLint length = 0;
  glGetShaderiv(shader.id(), GL_INFO_LOG_LENGTH, &length);
  std::string log(std::size_t(length), '\0');
  glGetShaderInfoLog(shader.id(), length, nullptr, log.data());
  throw Error(what, "its shader does not compile: " + first_line(log), "report this driver, or mend your own source");
}

}  // namespace

Program make_program(const std::string& what, std::string_view vertex, std::string_view fragment) {
  require_context();
  const Shader vertex_shader(GL_VERTEX_SHADER);
  const Shader fragment_shader(GL_FRAGMENT_SHADER);
  compile(what + " (vertex)", vertex_shader, vertex);
  compile(what + " (fragment)", fragment_shader, fragment);
  Program program;
  program.object_ = Object<Kind::program>(glCreateProgram());
  check("glCreateProgram");
  for (const GLuint shader : {vertex_shader.id(), fragment_shader.id()}) IVORY_GL(glAttachShader, program.id(), shader);
  IVORY_GL(glLinkProgram, program.id());
  for (const GLuint shader : {vertex_shader.id(), fragment_shader.id()}) IVORY_GL(glDetachShader, program.id(), shader);
  GLint good = GL_FALSE;
  glGetProgramiv(program.id(), GL_LINK_STATUS, &good);
  if (good != GL_TRUE) {
    GLint length = 0;
    glGetProgramiv(program.id(), GL_INFO_LOG_LENGTH, &length);
    std::string log(std::size_t(length), '\0');
    glGetProgramInfoLog(program.id(), length, nullptr, log.data());
    throw Error(what, "its shaders do not link: " + first_line(log), "report this driver, or mend your own source");
  }
  return program;
}

void Program::use() const { IVORY_GL(glUseProgram, object_.id()); }

std::string Program::full_name(const std::string& name) const {
  std::string full = name;
  for (auto slot = slots_.rbegin(); slot != slots_.rend(); ++slot) full = slot_name(*slot, full);
  return full;
}

int Program::location(const std::string& as_bound) {
  use();
  const std::string name = slots_.empty() ? as_bound : full_name(as_bound);
  const auto found = locations_.find(name);
  if (found != locations_.end()) return found->second;
  const int location = glGetUniformLocation(object_.id(), name.c_str());
  check("glGetUniformLocation");
  locations_.emplace(name, location);
  return location;
}

void Program::set(const std::string& name, int value) { IVORY_GL(glUniform1i, location(name), value); }
void Program::set(const std::string& name, float value) { IVORY_GL(glUniform1f, location(name), value); }
void Program::set(const std::string& name, const V3f& value) {
  IVORY_GL(glUniform3fv, location(name), 1, value.getValue());
}
void Program::set(const std::string& name, const V4f& value) { IVORY_GL(glUniform4fv, location(name), 1, &value.x); }
void Program::set(const std::string& name, const V3i& value) {
  IVORY_GL(glUniform3iv, location(name), 1, value.getValue());
}
// Imath keeps rows of matrices that act on row vectors: read as columns, they act on column vectors.
void Program::set(const std::string& name, const M33f& value) {
  IVORY_GL(glUniformMatrix3fv, location(name), 1, GLboolean(GL_FALSE), value.getValue());
}
void Program::set(const std::string& name, const M44f& value) {
  IVORY_GL(glUniformMatrix4fv, location(name), 1, GLboolean(GL_FALSE), value.getValue());
}
void Program::set_ivec4(const std::string& name, const std::array<int, 4>& value) {
  IVORY_GL(glUniform4iv, location(name), 1, value.data());
}
void Program::set(const std::string& name, const float* values, int count) {
  IVORY_GL(glUniform1fv, location(name), count, values);
}
void Program::set(const std::string& name, const V4f* values, int count) {
  IVORY_GL(glUniform4fv, location(name), count, &values->x);
}

void Program::bind_block(const std::string& name, const Buffer& buffer, int binding) {
  const GLuint index = glGetUniformBlockIndex(object_.id(), full_name(name).c_str());
  check("glGetUniformBlockIndex");
  if (index == GL_INVALID_INDEX) return;  // unused by the program
  // OpenGL 3.3 has 36 points at least and 24 blocks a program at most.
  constexpr int first_of_slots = 10;
  const auto point = GLuint(slots_.empty() ? binding : first_of_slots + int(index));
  IVORY_GL(glUniformBlockBinding, object_.id(), index, point);
  IVORY_GL(glBindBufferBase, GL_UNIFORM_BUFFER, point, buffer.id());
}

}  // namespace ivory::gl
