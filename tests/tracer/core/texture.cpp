// Texture look-up against values worked out by hand.
#include "tracer/core/texture.h"

#include <cmath>

#include <gtest/gtest.h>

namespace ivory {
namespace {

// 2 x 2 texels: red 0, 51 / 102, 255 of 255 (0, 0.2, 0.4, 1); green 188 (0.5029 once decoded from
// sRGB), alpha 128 everywhere.
Scene make_scene(Wrap wrap_s, Wrap wrap_t, bool nearest) {
  Scene scene;
  Image image;
  image.width = 2;
  image.height = 2;
  for (const int red : {0, 51, 102, 255})
    for (const int value : {red, 188, 0, 128}) image.rgba.push_back(static_cast<std::uint8_t>(value));
  scene.images.push_back(image);
  Texture texture;
  texture.image = 0;
  texture.wrap_s = wrap_s;
  texture.wrap_t = wrap_t;
  texture.nearest = nearest;
  scene.textures.push_back(texture);
  return scene;
}

float red(const Scene& scene, float u, float v) {
  TextureUse use;
  use.texture = 0;
  return sample(scene, use, {u, v}, false).x;
}

TEST(Texture, BilinearAtTexelCentresAndBetween) {
  const Scene scene = make_scene(Wrap::clamp_to_edge, Wrap::clamp_to_edge, false);
  // Row 0 is the top: v = 0.25 is its centre.
  EXPECT_FLOAT_EQ(red(scene, 0.25F, 0.25F), 0.0F);
  EXPECT_FLOAT_EQ(red(scene, 0.75F, 0.25F), 0.2F);
  EXPECT_FLOAT_EQ(red(scene, 0.25F, 0.75F), 0.4F);
  EXPECT_FLOAT_EQ(red(scene, 0.75F, 0.75F), 1.0F);
  EXPECT_FLOAT_EQ(red(scene, 0.5F, 0.25F), 0.1F);
  EXPECT_FLOAT_EQ(red(scene, 0.5F, 0.5F), 0.4F);
  // A quarter of the way right, half way down: 0.5 (0.75 0 + 0.25 0.2) + 0.5 (0.75 0.4 + 0.25 1)
  EXPECT_FLOAT_EQ(red(scene, 0.375F, 0.5F), 0.3F);
}

TEST(Texture, WrapModesBeyondTheEdge) {
  // At u = 1 the filter lies half on texel 1, half on the texel behind the edge.
  EXPECT_FLOAT_EQ(red(make_scene(Wrap::clamp_to_edge, Wrap::repeat, false), 1.0F, 0.25F), 0.2F);
  EXPECT_FLOAT_EQ(red(make_scene(Wrap::repeat, Wrap::repeat, false), 1.0F, 0.25F), 0.1F);
  EXPECT_FLOAT_EQ(red(make_scene(Wrap::mirrored_repeat, Wrap::repeat, false), 1.0F, 0.25F), 0.2F);
  // Centres of the texels behind it: u = 1.25 is texel 2.
  EXPECT_FLOAT_EQ(red(make_scene(Wrap::clamp_to_edge, Wrap::repeat, false), 1.25F, 0.25F), 0.2F);
  EXPECT_FLOAT_EQ(red(make_scene(Wrap::repeat, Wrap::repeat, false), 1.25F, 0.25F), 0.0F);
  EXPECT_FLOAT_EQ(red(make_scene(Wrap::mirrored_repeat, Wrap::repeat, false), 1.25F, 0.25F), 0.2F);
  EXPECT_FLOAT_EQ(red(make_scene(Wrap::mirrored_repeat, Wrap::repeat, false), 1.75F, 0.25F), 0.0F);
  EXPECT_FLOAT_EQ(red(make_scene(Wrap::mirrored_repeat, Wrap::repeat, false), 2.25F, 0.25F), 0.0F);
  // In front of the first edge, and the other axis.
  EXPECT_FLOAT_EQ(red(make_scene(Wrap::clamp_to_edge, Wrap::repeat, false), -7.0F, 0.25F), 0.0F);
  EXPECT_FLOAT_EQ(red(make_scene(Wrap::repeat, Wrap::repeat, false), -0.25F, 0.25F), 0.2F);
  EXPECT_FLOAT_EQ(red(make_scene(Wrap::mirrored_repeat, Wrap::repeat, false), -0.25F, 0.25F), 0.0F);
  EXPECT_FLOAT_EQ(red(make_scene(Wrap::repeat, Wrap::mirrored_repeat, false), 0.25F, 1.25F), 0.4F);
  EXPECT_FLOAT_EQ(red(make_scene(Wrap::repeat, Wrap::clamp_to_edge, false), 0.25F, -3.0F), 0.0F);
}

TEST(Texture, NearestTakesTheTexelItLiesIn) {
  const Scene scene = make_scene(Wrap::repeat, Wrap::repeat, true);
  EXPECT_FLOAT_EQ(red(scene, 0.49F, 0.49F), 0.0F);
  EXPECT_FLOAT_EQ(red(scene, 0.51F, 0.49F), 0.2F);
  EXPECT_FLOAT_EQ(red(scene, 0.49F, 0.51F), 0.4F);
  EXPECT_FLOAT_EQ(red(scene, -0.01F, -0.01F), 1.0F);
  EXPECT_FLOAT_EQ(red(scene, 1000.51F, 0.0F), 0.2F);
}

TEST(Texture, ColourIsDecodedFromSrgbBeforeFilteringAlphaNever) {
  const Scene scene = make_scene(Wrap::clamp_to_edge, Wrap::clamp_to_edge, false);
  TextureUse use;
  use.texture = 0;
  const V4f c = sample(scene, use, {0.5F, 0.25F}, true);
  // 51/255 = 0.2: ((0.2 + 0.055) / 1.055)^2.4 = 0.0331048; 188/255: 0.5028865
  EXPECT_NEAR(c.x, 0.5 * 0.0331048, 1e-6);
  EXPECT_NEAR(c.y, 0.5028865, 1e-6);
  EXPECT_FLOAT_EQ(c.w, 128.0F / 255.0F);
}

TEST(Texture, NoTextureIsWhiteAndWildCoordinatesStayInside) {
  const Scene scene = make_scene(Wrap::repeat, Wrap::repeat, false);
  EXPECT_EQ(sample(scene, TextureUse{}, {0.3F, 0.3F}, true), V4f(1, 1, 1, 1));
  for (const float wild : {1e30F, -1e30F, INFINITY, -INFINITY, std::nanf("")}) {
    const float value = red(scene, wild, 0.25F);
    EXPECT_TRUE(value >= 0 && value <= 1) << wild;
  }
}

TEST(Texture, UvIsInterpolatedThenTransformed) {
  Mesh mesh;
  mesh.triangles.emplace_back(0, 1, 2);
  mesh.uvs = {{}, {{0, 0}, {1, 0}, {0, 2}}};
  TextureUse use;
  use.uv_set = 1;
  use.uv_transform = {2, 0, 10, 0, 3, 20};
  EXPECT_EQ(uv_at(mesh, 0, {0.5F, 0.25F}, use), V2f(11, 21.5F));
  use.uv_set = 0;
  EXPECT_EQ(uv_at(mesh, 0, {0.5F, 0.25F}, use), V2f(0, 0));
  use.uv_set = 5;
  EXPECT_EQ(uv_at(mesh, 0, {0.5F, 0.25F}, use), V2f(0, 0));
}

}  // namespace
}  // namespace ivory
