// Frames of the renderer against closed forms.
#include "runtime/renderer/renderer.h"

#include <cmath>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "runtime/gl/check.h"
#include "tests/support/runtime_twin.h"

namespace ivory {

namespace {

// Colour in floats and depth, W x H, bound while it lives.
class Target {
 public:
  Target(int width, int height)
      : width_(width),
        height_(height),
        color_(gl::make_texture_2d("colour", gl::Format::rgba32f, width, height, nullptr, gl::Filter::nearest)),
        depth_(gl::make_texture_2d("depth", gl::Format::depth24, width, height, nullptr, gl::Filter::nearest)),
        framebuffer_(gl::make<gl::Kind::framebuffer>()) {
    IVORY_GL(glBindFramebuffer, GL_FRAMEBUFFER, framebuffer_.id());
    IVORY_GL(glFramebufferTexture2D, GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color_.object.id(), 0);
    IVORY_GL(glFramebufferTexture2D, GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_.object.id(), 0);
    IVORY_GL(glViewport, 0, 0, width, height);
  }
  ~Target() { glBindFramebuffer(GL_FRAMEBUFFER, 0); }
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  // Row 0 is the lowest.
  V4f pixel(int x, int y) const {
    V4f value;
    IVORY_GL(glReadPixels, x, y, 1, 1, GL_RGBA, GL_FLOAT, &value.x);
    return value;
  }
  float aspect() const { return float(width_) / float(height_); }

 private:
  int width_;
  int height_;
  gl::Texture color_;
  gl::Texture depth_;
  gl::Framebuffer framebuffer_;
};

// A square of half side `half` about the origin in the plane y = 0, facing up.
GpuMesh square(float half) {
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

SurfaceMaterial lambert(const Rgb& albedo) {
  SurfaceMaterial m;
  m.base_color = albedo;
  m.dielectric_f0 = Rgb(0, 0, 0);
  m.dielectric_f90 = 0;
  return m;
}

M44f translation(const V3f& t) {
  M44f m;
  m.setTranslation(t);
  return m;
}

// Looks straight down from a height of 4 m with 2 m of the plane in view: pixel (x, y) of n sees (2 x + 1)/n - 1.
RuntimeCamera from_above() {
  const M44f to_world(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 4, 0, 1);
  return make_orthographic(to_world, 1, 1, 0.1F, 10);
}

class RuntimeRenderer : public GlTest {};

TEST_F(RuntimeRenderer, ConstantAmbientIsAlbedoOverPiTimesE) {
  const Target target(8, 8);
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

// Radiance of a Lambert plane under lights right overhead: albedo/pi I cos^3/h^2, E albedo/pi.
TEST_F(RuntimeRenderer, PunctualLightsFollowTheirFormulas) {
  const Target target(16, 16);
  const GpuMesh mesh = square(2);
  const SurfaceMaterial material = lambert(Rgb(0.5F, 0.5F, 0.5F));
  const DrawItem item{&mesh, &material, M44f(), nullptr};
  const std::vector<ShadowCaster> casters{{&mesh, M44f()}};
  Renderer renderer;
  LightSet set;
  FrameParams frame;
  frame.camera = from_above();
  frame.items = {&item, 1};
  frame.lights = &set;
  const float x = 2 * 12.5F / 16 - 1;
  const float z = -(2 * 3.5F / 16 - 1);  // image rows run along -z

  RuntimeLight light;
  light.position_m = V3f(0, 2, 0);
  light.intensity = Rgb(8, 4, 2);
  set.update({&light, 1}, casters);
  renderer.draw(frame);
  const float d2 = x * x + z * z + 4;
  const float expected = 0.5F / pi * 8 * (2 / std::sqrt(d2)) / d2;
  EXPECT_NEAR(target.pixel(12, 3).x, expected, 1e-5F * expected);
  EXPECT_NEAR(target.pixel(12, 3).y, expected / 2, 1e-5F * expected);

  light.kind = LightKind::directional;
  light.direction = V3f(1, -1, 0).normalized();
  set.update({&light, 1}, casters);
  renderer.draw(frame);
  EXPECT_NEAR(target.pixel(12, 3).x, 0.5F / pi * 8 * std::sqrt(0.5F), 1e-5F);

  // glTF's cone: the square of a linear ramp in the cosine between the two angles.
  light.kind = LightKind::spot;
  light.direction = V3f(0, -1, 0);
  light.inner_angle_rad = 0.1F;
  light.outer_angle_rad = 0.5F;
  set.update({&light, 1}, casters);
  renderer.draw(frame);
  const float cosine = 2 / std::sqrt(d2);
  const float ramp = (cosine - std::cos(0.5F)) / (std::cos(0.1F) - std::cos(0.5F));
  ASSERT_GT(ramp, 0);
  EXPECT_NEAR(target.pixel(12, 3).x, expected * ramp * ramp, 1e-4F * expected);
  EXPECT_EQ(target.pixel(0, 0).x, 0);  // outside the cone
}

// A small square above the plane: its shadow is where the light does not see past it, and nowhere else, whatever
// the kind of light. A shadow texel is 1/1024 of the map, so points a pixel away from the edge are certain.
TEST_F(RuntimeRenderer, ShadowsFallWhereTheyShould) {
  const int n = 64;
  const Target target(n, n);
  const GpuMesh floor = square(1.5F);
  const GpuMesh blocker = square(0.1F);
  const SurfaceMaterial material = lambert(Rgb(1, 1, 1));
  const V3f blocker_at(0.2F, 1, -0.3F);
  const DrawItem item{&floor, &material, M44f(), nullptr};
  const std::vector<ShadowCaster> casters{{&floor, M44f()}, {&blocker, translation(blocker_at)}};
  Renderer renderer;
  LightSet set;
  FrameParams frame;
  frame.camera = from_above();
  frame.items = {&item, 1};
  frame.lights = &set;
  for (const LightKind kind : {LightKind::point, LightKind::spot, LightKind::directional}) {
    RuntimeLight light;
    light.kind = kind;
    light.position_m = V3f(-0.1F, 2, 0.05F);
    light.direction = V3f(0.1F, -1, -0.2F).normalized();
    light.outer_angle_rad = 1.2F;
    light.inner_angle_rad = 1.1F;
    set.update({&light, 1}, casters);
    renderer.draw(frame);
    int wrong = 0;
    int dark = 0;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const V3f p((2 * float(i) + 1) / n - 1, 0, -((2 * float(j) + 1) / n - 1));
        const V3f w = kind == LightKind::directional ? -light.direction : light.position_m - p;
        const V3f at = p + w * (1 / w.y) - blocker_at;  // where the ray passes the blocker's height
        const float reach = std::max(std::abs(at.x), std::abs(at.z));
        if (std::abs(reach - 0.1F) < 0.012F) continue;
        const bool lit = target.pixel(i, j).x > 0;
        wrong += int(lit != (reach > 0.1F));
        dark += int(!lit);
      }
    }
    EXPECT_EQ(wrong, 0) << int(kind);
    EXPECT_GT(dark, 20) << int(kind);
  }
}

// A mask whose texture is opaque in one half of x alone shades that half; a blended surface where it is half opaque.
TEST_F(RuntimeRenderer, MasksCastTheShadowOfWhatTheyCover) {
  const Target target(16, 16);
  const GpuMesh floor = square(2);
  const GpuMesh leaf = square(0.5F);
  std::vector<std::uint8_t> texels(8, 255);
  texels[3] = 0;  // the texel of low u, which lies at low x
  const gl::Texture texture =
      gl::make_texture_2d("t", gl::Format::srgb8_alpha8, 2, 1, texels.data(), gl::Filter::nearest);
  const SurfaceMaterial white = lambert(Rgb(1, 1, 1));
  SurfaceMaterial mask = white;
  mask.base_color_texture.texture = &texture;
  mask.coverage = Coverage::mask;
  const DrawItem item{&floor, &white, M44f(), nullptr};
  std::vector<ShadowCaster> casters{{&floor, M44f(), &white}, {&leaf, translation({0, 0.5F, 0}), &mask}};
  RuntimeLight light;
  light.kind = LightKind::directional;
  light.direction = V3f(0, -1, 0);
  LightSet set;
  Renderer renderer;
  FrameParams frame;
  frame.camera = from_above();
  frame.items = {&item, 1};
  frame.lights = &set;
  // Under the leaf's clear and its opaque half, and beside it.
  const auto lit = [&](float alpha, Coverage coverage) {
    mask.alpha = alpha;
    mask.coverage = coverage;
    set.update({&light, 1}, casters);
    renderer.draw(frame);
    return std::array<bool, 3>{target.pixel(6, 8).x > 0, target.pixel(9, 8).x > 0, target.pixel(14, 8).x > 0};
  };
  EXPECT_EQ(lit(1, Coverage::mask), (std::array<bool, 3>{true, false, true}));
  EXPECT_EQ(lit(1, Coverage::blend), (std::array<bool, 3>{true, false, true}));
  EXPECT_EQ(lit(0.3F, Coverage::blend), (std::array<bool, 3>{true, true, true}));
  EXPECT_EQ(lit(1, Coverage::opaque), (std::array<bool, 3>{false, false, true}));
}

TEST_F(RuntimeRenderer, BlendsMasksAndCulls) {
  const Target target(8, 8);
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
  const Target target(8, 8);
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
  const Target target(n, n);
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
    const Target target(8, 8);
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
