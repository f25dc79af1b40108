// The runtime's ground: contexts, OpenGL errors, shader text, textures.
#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/base/half.h"
#include "runtime/gl/check.h"
#include "runtime/gl/shader_source.h"
#include "tests/support/runtime_twin.h"

namespace ivory {

namespace {

class RuntimeCore : public GlTest {};

TEST(RuntimeContext, ItsAbsenceIsReported) {
  EXPECT_NE(error_of([] { gl::require_context(); }).find("no context is current"), std::string::npos);
}

TEST_F(RuntimeCore, ErrorsNameTheirCall) {
  EXPECT_EQ(
      error_of([] { IVORY_GL(glBindTexture, 0x1234, 0); }).find("OpenGL: glBindTexture failed with GL_INVALID_ENUM"),
      0U);
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST_F(RuntimeCore, ErrorsOfOthersAreNotLaidAtItsDoor) {
  glBindTexture(0x1234, 0);
  EXPECT_NO_THROW(gl::require_context());
  EXPECT_NO_THROW(gl::check("nothing"));
}

TEST_F(RuntimeCore, CompilersMessageNamesProgram) {
  const std::string message = error_of(
      [] { gl::make_program("the sky", "void main() { gl_Position = vec4(0.0); }", "void main() { oops; }"); });
  EXPECT_EQ(message.find("the sky (fragment): its shader does not compile"), 0U) << message;
  EXPECT_NE(message.find("oops"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST_F(RuntimeCore, TextureBeyondTheLimitIsRefused) {
  const int before = live_gl_objects();
  const std::string message = error_of([] {
    gl::make_texture_3d("big.vdb", gl::Format::rgb16f, {1 << 20, 1, 1}, nullptr, gl::Filter::linear);
  });
  EXPECT_EQ(message.find("big.vdb: needs a texture of 1048576 texels a side, and this OpenGL takes"), 0U) << message;
  EXPECT_EQ(live_gl_objects(), before);
}

// Drivers that cut digits off instead would make twice the error, and all of it to the dark side.
TEST_F(RuntimeCore, HalvesAreRoundedToNearest) {
  std::vector<V4f> texels;
  for (int i = 0; i < 1000; ++i) texels.emplace_back(1 + float(i) * 1e-4F, float(i) * 65.3F, -7.7F - float(i), 1e-5F);
  const gl::Texture texture =
      gl::make_texture_2d("halves", gl::Format::rgba16f, 1000, 1, texels.data(), gl::Filter::nearest);
  std::vector<V4f> stored(texels.size());
  glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_FLOAT, stored.data());
  for (std::size_t i = 0; i < texels.size(); ++i) {
    for (unsigned c = 0; c < 4; ++c) ASSERT_EQ(stored[i][c], rounded_to_half(texels[i][c])) << i;
  }
}

TEST_F(RuntimeCore, ObjectsAreDeletedWithTheirOwners) {
  const int before = live_gl_objects();
  {
    gl::Texture a = gl::make_texture_2d("a", gl::Format::rgba8, 4, 4, nullptr, gl::Filter::nearest);
    gl::Texture b = std::move(a);
    const auto buffer = gl::make<gl::Kind::buffer>();
    IVORY_GL(glBindBuffer, GL_ARRAY_BUFFER, buffer.id());
    EXPECT_EQ(live_gl_objects(), before + 2);
    EXPECT_EQ(b.bytes(), 64U);
  }
  EXPECT_EQ(live_gl_objects(), before);
}

// The harness itself: every input arrives, in order, as floats.
TEST_F(RuntimeCore, TwinHarnessKeepsOrderAndPrecision) {
  std::vector<V4f> a;
  std::vector<V4f> b;
  for (int i = 0; i < 10000; ++i) {
    a.emplace_back(float(i), 1e-20F * float(i), -1e20F, 0);
    b.emplace_back(1.0F / 3, 0, 0, float(i) * 0.5F);
  }
  const int before = live_gl_objects();
  const std::vector<V4f> out =
      evaluate_on_gpu("uniform float factor; vec4 evaluate(int i) { return factor * input0(i) + input1(i); }", {a, b},
                      [](gl::Program& program) { program.set("factor", 1.0F); });
  ASSERT_EQ(out.size(), a.size());
  for (std::size_t i = 0; i < out.size(); ++i) ASSERT_EQ(out[i], a[i] + b[i]) << i;
  EXPECT_EQ(live_gl_objects(), before);
}

TEST_F(RuntimeCore, MatricesActAsImathsDo) {
  M33f m(1, 2, 3, 4, 5, 6, 7, 8, 10);
  M44f m4(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 17);
  const V3f v(0.5F, -1, 2);
  const std::vector<V4f> out = evaluate_on_gpu(
      "uniform mat3 m; uniform mat4 m4; vec4 evaluate(int i) { return i == 0 ? vec4(m * input0(i).xyz, 0.0) : m4 * "
      "input0(i); }",
      {{to_v4(v, 1), to_v4(v, 1)}}, [&](gl::Program& program) {
        program.set("m", m);
        program.set("m4", m4);
      });
  EXPECT_EQ(xyz(out[0]), v * m);
  const V3f projected = v * m4;  // divides by w
  EXPECT_LT((xyz(out[1]) / out[1].w - projected).length(), 1e-6F);
}

TEST(RuntimeShaders, AreEmbeddedAndResolved) {
  for (const std::string& name : shader_names()) {
    const std::string text = shader_source(name);
    EXPECT_EQ(text.find("#include"), std::string::npos) << name;
    EXPECT_EQ(text.find("#version"), std::string::npos) << name;
  }
  EXPECT_EQ(error_of([] { shader_source("nothing.glsl"); }).find("shaders/nothing.glsl: no such shader"), 0U);
}

TEST(RuntimeHalf, RoundsToNearestEven) {
  EXPECT_EQ(rounded_to_half(1.0F + 1.0F / 2048), 1.0F);
  EXPECT_EQ(rounded_to_half(1.0F + 3.0F / 2048), 1.0F + 2.0F / 1024);
}

}  // namespace

}  // namespace ivory
