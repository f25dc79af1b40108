#include "tests/support/runtime_twin.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "grid/base/error.h"
#include "runtime/gl/check.h"

namespace ivory {

namespace {

constexpr int width = 256;
constexpr int first_input_unit = 12;

constexpr const char* vertex_source = R"(
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

std::string fragment_source(const std::string& source, std::size_t inputs) {
  std::string text;
  for (std::size_t k = 0; k < inputs; ++k) {
    text += fmt::format(
        "uniform sampler2D twin_in{0};\n"
        "vec4 input{0}(int i) {{ return texelFetch(twin_in{0}, ivec2(i % {1}, i / {1}), 0); }}\n",
        k, width);
  }
  return text + source +
         fmt::format(
             "\nout vec4 twin_result;\n"
             "void main() {{ twin_result = evaluate(int(gl_FragCoord.y) * {} + int(gl_FragCoord.x)); }}\n",
             width);
}

}  // namespace

std::vector<V4f> evaluate_on_gpu(const std::string& source, const std::vector<std::vector<V4f>>& inputs,
                                 const BindProgram& bind) {
  gl::require_context();
  if (inputs.empty() || inputs.size() > 4) throw std::invalid_argument("one to four inputs");
  const std::size_t count = inputs.front().size();
  const int height = int((count + width - 1) / width);
  gl::Program program = gl::make_program("twin", vertex_source, fragment_source(source, inputs.size()));
  std::vector<gl::Texture> textures;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    std::vector<V4f> texels = inputs[k];
    if (texels.size() != count) throw std::invalid_argument("inputs of unequal length");
    // The rest of the last row is computed too, and what a vector is made of without a value is what memory held: a
    // normal of 1e-40 sends llvmpipe's cube maps far outside of their texels.
    texels.resize(std::size_t(width) * std::size_t(height), texels.back());
    textures.push_back(
        gl::make_texture_2d("input", gl::Format::rgba32f, width, height, texels.data(), gl::Filter::nearest));
  }
  const gl::Texture target =
      gl::make_texture_2d("result", gl::Format::rgba32f, width, height, nullptr, gl::Filter::nearest);
  const auto framebuffer = gl::make<gl::Kind::framebuffer>();
  const auto vertices = gl::make<gl::Kind::vertex_array>();
  IVORY_GL(glBindFramebuffer, GL_FRAMEBUFFER, framebuffer.id());
  IVORY_GL(glFramebufferTexture2D, GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target.object.id(), 0);
  IVORY_GL(glBindVertexArray, vertices.id());
  IVORY_GL(glViewport, 0, 0, width, height);
  IVORY_GL(glDisable, GL_DEPTH_TEST);
  IVORY_GL(glDisable, GL_BLEND);
  if (bind) bind(program);
  for (std::size_t k = 0; k < textures.size(); ++k) {
    program.set(fmt::format("twin_in{}", k), first_input_unit + int(k));
    gl::bind(textures[k], first_input_unit + int(k));
  }
  program.use();
  IVORY_GL(glDrawArrays, GL_TRIANGLES, 0, 3);
  std::vector<V4f> result(std::size_t(width) * std::size_t(height));
  IVORY_GL(glReadPixels, 0, 0, width, height, GL_RGBA, GL_FLOAT, result.data());
  IVORY_GL(glBindFramebuffer, GL_FRAMEBUFFER, 0);
  IVORY_GL(glUseProgram, 0);  // a program in use outlives its owner
  result.resize(count);
  return result;
}

int live_gl_objects() {
  int count = 0;
  for (GLuint id = 1; id < 4096; ++id) {
    count += int(glIsTexture(id)) + int(glIsBuffer(id)) + int(glIsVertexArray(id)) + int(glIsFramebuffer(id)) +
             int(glIsRenderbuffer(id)) + int(glIsProgram(id)) + int(glIsShader(id)) + int(glIsQuery(id));
  }
  return count;
}

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

void expect_damage_refused(const std::string& good, const std::function<void(const std::string& path)>& load) {
  std::ifstream file(good, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::string bad = good + ".damaged.exr";
  const int before = live_gl_objects();
  for (const std::string& content : {bytes.substr(0, bytes.size() / 2), bytes.substr(0, 10), std::string(),
                                     std::string("no picture at all, but a file of text that someone dropped")}) {
    std::ofstream(bad, std::ios::binary) << content;
    const std::string message = error_of([&] { load(bad); });
    EXPECT_EQ(message.find(bad), 0U) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_EQ(live_gl_objects(), before);
  }
  EXPECT_NE(error_of([&] { load(good + ".missing.exr"); }), "");
}

}  // namespace ivory
