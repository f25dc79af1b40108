// Frames of the renderer against closed forms.
#include "runtime/renderer/renderer.h"

#include <cmath>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/render_target.h"

namespace ivory {

namespace {

class RuntimeRenderer : public GlTest {};

TEST_F(RuntimeRenderer, ConstantAmbientIsAlbedoOverPiTimesE) {
  const RenderTarget target(8, 8);
  const GpuMesh mesh = square(2);
  const SurfaceMaterial material = lambert(Rgb(0.5F, 0.25F, 1));
  const AmbientSource ambient = constant_ambient(Rgb(pi, 2 * pi, 4 * pi));
  const DrawItem item{&mesh, &material, M44f(), &ambient};
  Renderer renderer;
  FrameParams frame;
  frame.camera = from_above();
  frame.items = {&item, 1};
  frame.exposure = 2;
  renderer.draw(frame);
  const V4f pixel = target.pixel(3, 5);
  EXPECT_NEAR(pixel.x, 1, 1e-6F);
  EXPECT_NEAR(pixel.y, 1, 1e-6F);
  EXPECT_NEAR(pixel.z, 8, 8e-6F);
  EXPECT_EQ(pixel.w, 1);
}

TEST_F(RuntimeRenderer, BlendsMasksAndCulls) {
  const RenderTarget target(8, 8);
  const GpuMesh mesh = square(2);
  SurfaceMaterial white = lambert(Rgb(1, 1, 1));
  SurfaceMaterial glass = lambert(Rgb(0, 0, 0));
  glass.coverage = Coverage::blend;
  glass.alpha = 0.25F;
  SurfaceMaterial cut = glass;
  cut.coverage = Coverage::mask;
  M44f turned;
  turned.setEulerAngles(V3f(pi, 0, 0));  // faces down
  const AmbientSource ambient = constant_ambient(Rgb(pi, pi, pi));
  std::vector<DrawItem> items{{&mesh, &glass, translation({0, 0.5F, 0}), &ambient},
                              {&mesh, &white, M44f(), &ambient},
                              {&mesh, &cut, translation({0, 1, 0}), &ambient},
                              {&mesh, &cut, turned * translation({0, 1.5F, 0}), &ambient}};
  Renderer renderer;
  FrameParams frame;
  frame.camera = from_above();
  frame.items = items;
  renderer.draw(frame);
  EXPECT_NEAR(target.pixel(4, 4).x, 0.75F, 1e-6F);

  // Above the cutoff the mask is opaque; from behind it is not there.
  cut.alpha_cutoff = 0.2F;
  items.erase(items.begin() + 2);
  frame.items = items;
  renderer.draw(frame);
  EXPECT_NEAR(target.pixel(4, 4).x, 0.75F, 1e-6F);
  cut.double_sided = true;
  frame.items = items;
  renderer.draw(frame);
  EXPECT_NEAR(target.pixel(4, 4).x, 0, 1e-6F);
}

TEST_F(RuntimeRenderer, TexturesAreLinearisedAndPlaced) {
  const RenderTarget target(8, 8);
  const GpuMesh mesh = square(1);
  // Four texels, one of them grey 188: 0.5029 of full linear light.
  std::vector<std::uint8_t> texels(16, 255);
  texels[0] = texels[1] = texels[2] = 188;
  const gl::Texture texture =
      gl::make_texture_2d("t", gl::Format::srgb8_alpha8, 2, 2, texels.data(), gl::Filter::nearest);
  SurfaceMaterial material = lambert(Rgb(1, 1, 1));
  material.base_color_texture.texture = &texture;
  const AmbientSource ambient = constant_ambient(Rgb(pi, pi, pi));
  const DrawItem item{&mesh, &material, M44f(), &ambient};
  Renderer renderer;
  FrameParams frame;
  frame.camera = from_above();
  frame.items = {&item, 1};
  renderer.draw(frame);
  // uv (0,0) is at x = z = -1: the upper left of the picture.
  EXPECT_NEAR(target.pixel(1, 6).x, 0.5029F, 2e-3F);
  EXPECT_NEAR(target.pixel(6, 6).x, 1, 1e-6F);
  EXPECT_NEAR(target.pixel(1, 1).x, 1, 1e-6F);
  // Half a turn in uv moves it to the other corner.
  material.base_color_texture.uv_transform = {-1, 0, 1, 0, -1, 1};
  renderer.draw(frame);
  EXPECT_NEAR(target.pixel(6, 1).x, 0.5029F, 2e-3F);
  EXPECT_NEAR(target.pixel(1, 6).x, 1, 1e-6F);
}

TEST_F(RuntimeRenderer, SkyIsTheEnvironmentsWayRound) {
  const int n = 9;
  const RenderTarget target(n, n);
  // 4 x 2 texels, each another value: row 0 is up, the middle column boundary looks along +Z, +X lies to its left.
  std::vector<V4f> texels;
  for (int i = 0; i < 8; ++i) texels.emplace_back(float(i), 0.0F, 0.0F, 1.0F);
  const gl::Texture sky = gl::make_texture_2d("sky", gl::Format::rgba32f, 4, 2, texels.data(), gl::Filter::nearest);
  Renderer renderer;
  FrameParams frame;
  frame.sky = &sky;
  const auto looks_along = [&](const V3f& z_axis, const V3f& x_axis) {
    const V3f y = z_axis.cross(x_axis);
    return M44f(x_axis.x, x_axis.y, x_axis.z, 0, y.x, y.y, y.z, 0, z_axis.x, z_axis.y, z_axis.z, 0, 0, 0, 0, 1);
  };
  // Camera +Z backwards. Looking along +X (u = 1/4): columns 0 and 1 meet, +Z (right of it: u grows) to its right.
  frame.camera = make_perspective(looks_along({-1, 0, 0}, {0, 0, 1}), 1.5F, 1, 0.1F, 10);
  renderer.draw(frame);
  EXPECT_EQ(target.pixel(1, 7).x, 0);
  EXPECT_EQ(target.pixel(7, 7).x, 1);
  EXPECT_EQ(target.pixel(1, 1).x, 4);
  // Looking along +Z: columns 1 (+X side) and 2; +X lies to the left of one who looks along +Z with +Y up.
  frame.camera = make_perspective(looks_along({0, 0, -1}, {-1, 0, 0}), 1.5F, 1, 0.1F, 10);
  renderer.draw(frame);
  EXPECT_EQ(target.pixel(1, 7).x, 1);
  EXPECT_EQ(target.pixel(7, 7).x, 2);
}

TEST_F(RuntimeRenderer, NothingIsLeftBehind) {
  glUseProgram(0);  // a program of another test lives on while it is in use
  const int before = live_gl_objects();
  {
    const RenderTarget target(8, 8);
    const GpuMesh mesh = square(1);
    const SurfaceMaterial material = lambert(Rgb(1, 1, 1));
    const DrawItem item{&mesh, &material, M44f(), nullptr};
    const ShadowCaster caster{&mesh, M44f()};
    const RuntimeLight light;
    LightSet set;
    set.update({&light, 1}, {&caster, 1});
    Renderer renderer;
    FrameParams frame;
    frame.camera = from_above();
    frame.items = {&item, 1};
    frame.lights = &set;
    renderer.draw(frame);
    EXPECT_GT(live_gl_objects(), before);
    glUseProgram(0);
  }
  EXPECT_EQ(live_gl_objects(), before);
}

TEST_F(RuntimeRenderer, BadMeshesAndTooManyLightsAreRefused) {
  const int before = live_gl_objects();
  const std::vector<V3f> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Imath::Vec3<std::uint32_t>> wrong{{0, 1, 3}};
  MeshData data;
  data.positions = positions;
  EXPECT_THROW(upload(data), Error);
  data.triangles = wrong;
  EXPECT_THROW(upload(data), Error);
  EXPECT_EQ(live_gl_objects(), before);
  LightSet set;
  const std::vector<RuntimeLight> lights(max_lights + 1);
  EXPECT_THROW(set.update(lights, {}), Error);
}

}  // namespace

}  // namespace ivory
