// Where the viewer draws: linear light in floats, averaged over the points of a pixel, then a picture for a display.
#pragma once

#include "runtime/gl/gl.h"
#include "tracer/core/film.h"
#include "tracer/image/file.h"

namespace ivory {

class ViewTarget {
 public:
  // Pixels. Needs a current context. Throws Error where OpenGL has no room for it, or cannot draw into floats.
  ViewTarget(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t bytes() const;  // on the GPU

  // Draw one point of each pixel between the two: begin() binds the framebuffer (RGBA32F and depth), sets the viewport
  // and clears to black, alpha 0; add() puts the result into the mean. reset() starts a new mean.
  void reset();
  void begin();
  void add();
  // Adds another picture of the same point to the last one that was added: its light, with alpha left as it is.
  void add_light();
  int samples() const { return samples_; }

  // The mean of what was added: radiance in nits, or whatever was drawn; alpha is the share of the pixel covered.
  const gl::Texture& mean() const { return mean_; }
  Film read_mean() const;  // without alpha; waits until it is drawn

  // Binds the framebuffer that display passes draw into, of the same size.
  void begin_display();
  DisplayImage read_display() const;  // waits until it is drawn
  // Copies the display picture to the bound window framebuffer's lower left corner.
  void show() const;

 private:
  void begin_mean(bool blend);
  void draw_into_mean();

  int width_;
  int height_;
  int samples_ = 0;
  gl::Texture color_;
  gl::Renderbuffer depth_;
  gl::Framebuffer draw_;
  gl::Texture mean_;
  gl::Framebuffer mean_framebuffer_;
  gl::Texture display_;
  gl::Framebuffer display_framebuffer_;
  gl::Program add_;
  gl::VertexArray no_vertices_;
};

// Vertex shader of a triangle over the whole picture; drawn by draw_full_picture().
extern const char* const full_picture_vertex_shader;
void draw_full_picture(const gl::VertexArray& no_vertices);

}  // namespace ivory
