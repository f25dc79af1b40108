// The renderer's punctual lights and their shadows against closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "runtime/renderer/punctual_light.h"
#include "tests/support/render_target.h"

namespace ivory {

namespace {

class RuntimeLights : public GlTest {};

// Radiance of a Lambert plane under lights right overhead: albedo/pi I cos^3/h^2, E albedo/pi.
TEST_F(RuntimeLights, PunctualLightsFollowTheirFormulas) {
  const RenderTarget target(16, 16);
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

  // A hard edge just behind the point, and just before it; of a cone of a tenth of a degree, on its axis.
  for (const float change : {1e-3F, -1e-3F}) {
    light.inner_angle_rad = light.outer_angle_rad = std::acos(cosine) + change;
    set.update({&light, 1}, casters);
    renderer.draw(frame);
    EXPECT_NEAR(target.pixel(12, 3).x, change > 0 ? expected : 0, 1e-5F * expected);
  }
  light.direction = (V3f(x, 0, z) - light.position_m).normalized();
  light.inner_angle_rad = light.outer_angle_rad = 0.0017F;
  set.update({&light, 1}, casters);
  renderer.draw(frame);
  EXPECT_NEAR(target.pixel(12, 3).x, expected, 1e-5F * expected);
}

// A patch gives I cos cos' / (r^2 + A / pi), nothing behind it, and never more than a wall of its radiance: pi L.
TEST_F(RuntimeLights, PatchesShineByTheCosineAndAreBounded) {
  const RenderTarget target(16, 16);
  const GpuMesh mesh = square(2);
  const SurfaceMaterial material = lambert(Rgb(1, 1, 1));
  const DrawItem item{&mesh, &material, M44f(), nullptr};
  Renderer renderer;
  LightSet set;
  FrameParams frame;
  frame.camera = from_above();
  frame.items = {&item, 1};
  frame.lights = &set;
  const V3f p(2 * 12.5F / 16 - 1, 0, -(2 * 3.5F / 16 - 1));
  RuntimeLight light;
  light.kind = LightKind::patch;
  light.extent = 0.3F;
  light.intensity = Rgb(10 * light.extent, 5 * light.extent, 1);
  light.position_m = V3f(0.1F, 1.2F, -0.2F);
  light.direction = V3f(0.2F, -1, 0.3F).normalized();
  set.update({&light, 1}, {});
  renderer.draw(frame);
  const V3f d = light.position_m - p;
  const V3f w = d.normalized();
  const float expected = light.intensity.x / pi * w.y * -w.dot(light.direction) / (d.length2() + light.extent / pi);
  ASSERT_GT(expected, 0);
  EXPECT_NEAR(target.pixel(12, 3).x, expected, 1e-5F * expected);
  EXPECT_NEAR(target.pixel(12, 3).y, expected / 2, 1e-5F * expected);
  light.direction = -light.direction;
  set.update({&light, 1}, {});
  renderer.draw(frame);
  EXPECT_EQ(target.pixel(12, 3).x, 0);
  // A millimetre above: radiance of the patch, albedo 1.
  light.direction = V3f(0, -1, 0);
  light.position_m = p + V3f(0, 1e-3F, 0);
  set.update({&light, 1}, {});
  renderer.draw(frame);
  EXPECT_NEAR(target.pixel(12, 3).x, 10, 0.01F);
  // Emission comes with the first of several pictures alone, and what holds the light already has no more of it.
  SurfaceMaterial shining = material;
  shining.emission = Rgb(7, 7, 7);
  DrawItem lit{&mesh, &shining, M44f(), nullptr};
  frame.items = {&lit, 1};
  renderer.draw(frame);
  EXPECT_NEAR(target.pixel(12, 3).x, 17, 0.01F);
  frame.emission = false;
  renderer.draw(frame);
  EXPECT_NEAR(target.pixel(12, 3).x, 10, 0.01F);
  lit.direct = false;
  renderer.draw(frame);
  EXPECT_EQ(target.pixel(12, 3).x, 0);
}

// A small square above the plane: its shadow is where the light does not see past it, and nowhere else, whatever
// the kind of light. A shadow texel is 1/1024 of the map, so points a pixel away from the edge are certain.
TEST_F(RuntimeLights, ShadowsFallWhereTheyShould) {
  const int n = 64;
  const RenderTarget target(n, n);
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
  for (const LightKind kind : {LightKind::point, LightKind::spot, LightKind::directional, LightKind::patch}) {
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
TEST_F(RuntimeLights, MasksCastTheShadowOfWhatTheyCover) {
  const RenderTarget target(16, 16);
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

}  // namespace

}  // namespace ivory
