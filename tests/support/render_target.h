// What tests of the renderer draw into, and simple things to draw.
#pragma once

#include <vector>

#include <epoxy/gl.h>

#include "runtime/gl/check.h"
#include "runtime/renderer/renderer.h"
#include "tests/support/runtime_twin.h"

namespace ivory {

// Colour in floats and depth, W x H, bound while it lives.
class RenderTarget {
 public:
  RenderTarget(int width, int height)
      : color_(gl::make_texture_2d("colour", gl::Format::rgba32f, width, height, nullptr, gl::Filter::nearest)),
        depth_(gl::make_texture_2d("depth", gl::Format::depth24, width, height, nullptr, gl::Filter::nearest)),
        framebuffer_(gl::make<gl::Kind::framebuffer>()) {
    IVORY_GL(glBindFramebuffer, GL_FRAMEBUFFER, framebuffer_.id());
    IVORY_GL(glFramebufferTexture2D, GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color_.object.id(), 0);
    IVORY_GL(glFramebufferTexture2D, GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_.object.id(), 0);
    IVORY_GL(glViewport, 0, 0, width, height);
  }
  ~RenderTarget() { glBindFramebuffer(GL_FRAMEBUFFER, 0); }
  RenderTarget(const RenderTarget&) = delete;
  RenderTarget& operator=(const RenderTarget&) = delete;

  // Row 0 is the lowest.
  V4f pixel(int x, int y) const {
    V4f value;
    IVORY_GL(glReadPixels, x, y, 1, 1, GL_RGBA, GL_FLOAT, &value.x);
    return value;
  }

 private:
  gl::Texture color_;
  gl::Texture depth_;
  gl::Framebuffer framebuffer_;
};

// A square of half side `half` about the origin in the plane y = 0, facing up.
inline GpuMesh square(float half) {
  const std::vector<V3f> positions{{-half, 0, -half}, {-half, 0, half}, {half, 0, half}, {half, 0, -half}};
  const std::vector<V3f> normals(4, V3f(0, 1, 0));
  const std::vector<V2f> uvs{{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  const std::vector<Imath::Vec3<std::uint32_t>> triangles{{0, 1, 2}, {0, 2, 3}};
  MeshData data;
  data.positions = positions;
  data.normals = normals;
  data.uv0 = uvs;
  data.triangles = triangles;
  return upload(data);
}

inline SurfaceMaterial lambert(const Rgb& albedo) {
  SurfaceMaterial m;
  m.base_color = albedo;
  m.dielectric_f0 = Rgb(0, 0, 0);
  m.dielectric_f90 = 0;
  return m;
}

inline M44f translation(const V3f& t) {
  M44f m;
  m.setTranslation(t);
  return m;
}

// Looks straight down from a height of 4 m with 2 m of the plane in view: pixel (x, y) of n sees (2 x + 1)/n - 1.
inline RuntimeCamera from_above() {
  const M44f to_world(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 4, 0, 1);
  return make_orthographic(to_world, 1, 1, 0.1F, 10);
}

}  // namespace ivory
