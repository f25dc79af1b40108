#include "tools/view/draw/target.h"

#include "grid/base/error.h"
#include "runtime/gl/check.h"

namespace ivory {

namespace {

// The new point's share of the mean is 1/k: blended with that factor, all points weigh the same in the end.
constexpr const char* add_shader = R"(
uniform sampler2D picture;
out vec4 color;
void main() { color = texelFetch(picture, ivec2(gl_FragCoord.xy), 0); }
)";

void attach(const gl::Framebuffer& framebuffer, const gl::Texture& texture) {
  IVORY_GL(glBindFramebuffer, GL_FRAMEBUFFER, framebuffer.id());
  IVORY_GL(glFramebufferTexture2D, GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture.object.id(), 0);
}

void require_complete() {
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error("OpenGL", "this driver cannot draw into float pictures", "use a driver that can, such as Mesa's");
}

}  // namespace

const char* const full_picture_vertex_shader = R"(
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

void draw_full_picture(const gl::VertexArray& no_vertices) {
  IVORY_GL(glBindVertexArray, no_vertices.id());
  IVORY_GL(glDrawArrays, GL_TRIANGLES, 0, 3);
}

ViewTarget::ViewTarget(int width, int height) : width_(width), height_(height) {
  gl::require_context();
  const auto picture = [&](gl::Format format) {
    return gl::make_texture_2d("the picture", format, width, height, nullptr, gl::Filter::nearest);
  };
  color_ = picture(gl::Format::rgba32f);
  mean_ = picture(gl::Format::rgba32f);
  display_ = picture(gl::Format::rgba8);
  depth_ = gl::make<gl::Kind::renderbuffer>();
  IVORY_GL(glBindRenderbuffer, GL_RENDERBUFFER, depth_.id());
  IVORY_GL(glRenderbufferStorage, GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  draw_ = gl::make<gl::Kind::framebuffer>();
  mean_framebuffer_ = gl::make<gl::Kind::framebuffer>();
  display_framebuffer_ = gl::make<gl::Kind::framebuffer>();
  attach(draw_, color_);
  IVORY_GL(glFramebufferRenderbuffer, GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.id());
  require_complete();
  attach(mean_framebuffer_, mean_);
  require_complete();
  attach(display_framebuffer_, display_);
  require_complete();
  add_ = gl::make_program("mean of points", full_picture_vertex_shader, add_shader);
  no_vertices_ = gl::make<gl::Kind::vertex_array>();
}

std::size_t ViewTarget::bytes() const {
  const std::size_t depth = std::size_t(width_) * std::size_t(height_) * 4;
  return color_.bytes() + mean_.bytes() + display_.bytes() + depth;
}

void ViewTarget::reset() { samples_ = 0; }

void ViewTarget::begin() {
  IVORY_GL(glBindFramebuffer, GL_FRAMEBUFFER, draw_.id());
  IVORY_GL(glViewport, 0, 0, width_, height_);
  IVORY_GL(glDisable, GL_SCISSOR_TEST);
  IVORY_GL(glDisable, GL_BLEND);
  IVORY_GL(glColorMask, GLboolean(GL_TRUE), GLboolean(GL_TRUE), GLboolean(GL_TRUE), GLboolean(GL_TRUE));
  IVORY_GL(glDepthMask, GLboolean(GL_TRUE));
  IVORY_GL(glClearColor, 0.0F, 0.0F, 0.0F, 0.0F);
  IVORY_GL(glClearDepth, 1.0);
  IVORY_GL(glClear, GLbitfield(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT));
  IVORY_GL(glEnable, GL_DEPTH_TEST);
  IVORY_GL(glDepthFunc, GL_LESS);
}

void ViewTarget::draw_into_mean() {
  add_.use();
  gl::bind(color_, 0);
  add_.set("picture", 0);
  draw_full_picture(no_vertices_);
  IVORY_GL(glDisable, GL_BLEND);
}

void ViewTarget::begin_mean(bool blend) {
  const float share = 1.0F / float(samples_);
  IVORY_GL(glBindFramebuffer, GL_FRAMEBUFFER, mean_framebuffer_.id());
  IVORY_GL(glViewport, 0, 0, width_, height_);
  IVORY_GL(glDisable, GL_DEPTH_TEST);
  IVORY_GL(glDisable, GL_CULL_FACE);
  if (!blend) {
    IVORY_GL(glDisable, GL_BLEND);
    return;
  }
  IVORY_GL(glEnable, GL_BLEND);
  IVORY_GL(glBlendEquation, GL_FUNC_ADD);
  IVORY_GL(glBlendColor, share, share, share, share);
}

void ViewTarget::add() {
  ++samples_;
  begin_mean(samples_ > 1);  // what was there before the first may not be a number
  if (samples_ > 1) IVORY_GL(glBlendFunc, GL_CONSTANT_COLOR, GL_ONE_MINUS_CONSTANT_COLOR);
  draw_into_mean();
}

void ViewTarget::add_light() {
  begin_mean(true);
  IVORY_GL(glBlendFuncSeparate, GL_CONSTANT_COLOR, GL_ONE, GL_ZERO, GL_ONE);
  draw_into_mean();
}

namespace {

// OpenGL's first row is the lowest.
template <typename Pixel, typename Read>
std::vector<Pixel> read_rows(int width, int height, int per_pixel, const Read& read) {
  std::vector<Pixel> upward(std::size_t(width) * std::size_t(height) * std::size_t(per_pixel));
  IVORY_GL(glBindBuffer, GL_PIXEL_PACK_BUFFER, 0);
  IVORY_GL(glPixelStorei, GL_PACK_ALIGNMENT, 1);
  IVORY_GL(glPixelStorei, GL_PACK_ROW_LENGTH, 0);
  read(upward.data());
  std::vector<Pixel> downward;
  downward.reserve(upward.size());
  const auto row = std::ptrdiff_t(width) * per_pixel;
  for (std::ptrdiff_t y = height; y-- > 0;)
    downward.insert(downward.end(), upward.begin() + y * row, upward.begin() + (y + 1) * row);
  return downward;
}

}  // namespace

Film ViewTarget::read_mean() const {
  IVORY_GL(glBindFramebuffer, GL_FRAMEBUFFER, mean_framebuffer_.id());
  Film film{width_, height_, {}};
  film.pixels = read_rows<Rgb>(width_, height_, 1, [&](Rgb* pixels) {
    IVORY_GL(glReadPixels, 0, 0, width_, height_, GL_RGB, GL_FLOAT, pixels);
  });
  return film;
}

void ViewTarget::begin_display() {
  IVORY_GL(glBindFramebuffer, GL_FRAMEBUFFER, display_framebuffer_.id());
  IVORY_GL(glViewport, 0, 0, width_, height_);
  IVORY_GL(glDisable, GL_DEPTH_TEST);
  IVORY_GL(glDisable, GL_CULL_FACE);
  IVORY_GL(glDisable, GL_BLEND);
}

DisplayImage ViewTarget::read_display() const {
  IVORY_GL(glBindFramebuffer, GL_FRAMEBUFFER, display_framebuffer_.id());
  DisplayImage image{width_, height_, {}};
  image.rgb = read_rows<std::uint8_t>(width_, height_, 3, [&](std::uint8_t* bytes) {
    IVORY_GL(glReadPixels, 0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE, bytes);
  });
  return image;
}

void ViewTarget::show() const {
  IVORY_GL(glBindFramebuffer, GL_READ_FRAMEBUFFER, display_framebuffer_.id());
  IVORY_GL(glBindFramebuffer, GL_DRAW_FRAMEBUFFER, 0);
  IVORY_GL(glBlitFramebuffer, 0, 0, width_, height_, 0, 0, width_, height_, GLbitfield(GL_COLOR_BUFFER_BIT),
           GLenum(GL_NEAREST));
  IVORY_GL(glBindFramebuffer, GL_FRAMEBUFFER, 0);
}

}  // namespace ivory
