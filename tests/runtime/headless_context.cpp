// The context without a window: that it draws, and that several live side by side.
#include "runtime/gl/headless_context.h"

#include <array>
#include <memory>
#include <utility>

#include <epoxy/gl.h>
#include <gtest/gtest.h>

namespace ivory {
namespace {

// A 2x1 RGBA32F framebuffer cleared to `value`, as read back.
std::array<float, 8> clear_and_read(float value) {
  GLuint texture = 0;
  GLuint framebuffer = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 2, 1, 0, GL_RGBA, GL_FLOAT, nullptr);
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
  EXPECT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), GLenum(GL_FRAMEBUFFER_COMPLETE));
  glClearColor(value, 2 * value, 3 * value, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  std::array<float, 8> pixels{};
  glReadPixels(0, 0, 2, 1, GL_RGBA, GL_FLOAT, pixels.data());
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
  glDeleteFramebuffers(1, &framebuffer);
  glDeleteTextures(1, &texture);
  return pixels;
}

TEST(HeadlessContext, DrawsInOpenGl33Core) {
  const HeadlessContext context;
  EXPECT_GE(epoxy_gl_version(), 33);
  EXPECT_TRUE(epoxy_is_desktop_gl());
  GLint profile = 0;
  glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
  EXPECT_TRUE(profile & GL_CONTEXT_CORE_PROFILE_BIT);
  EXPECT_NE(gl_description().find("OpenGL"), std::string::npos);
  const std::array<float, 8> expected{1000, 2000, 3000, 1, 1000, 2000, 3000, 1};
  EXPECT_EQ(clear_and_read(1000), expected);
}

TEST(HeadlessContext, SeveralLiveAtOnceAndOneAfterAnother) {
  auto first = std::make_unique<HeadlessContext>();
  HeadlessContext second;
  EXPECT_EQ(clear_and_read(0.5F)[0], 0.5F);
  first->make_current();
  EXPECT_EQ(clear_and_read(0.25F)[0], 0.25F);
  first.reset();
  second.make_current();
  const HeadlessContext moved = std::move(second);
  EXPECT_EQ(clear_and_read(0.125F)[0], 0.125F);
}

}  // namespace
}  // namespace ivory
