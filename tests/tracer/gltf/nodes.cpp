// Lights, cameras and nodes of glTF files.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/gltf_check.h"

namespace ivory {
namespace {

using nlohmann::json;

TEST(GltfLights, DirectionUnitsAndCones) {
  GltfBuilder builder;
  builder.use_extension("KHR_lights_punctual");
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0.25}}, {"intensity", 8}, {"range", 3}},
      {{"type", "spot"}, {"intensity", 5}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}},
      {{"type", "directional"}, {"intensity", 1000}},
      {{"type", "spot"}, {"spot", json::object()}},
      {{"type", "area"}}};
  const auto light_node = [](int light) { return json{{"KHR_lights_punctual", {{"light", light}}}}; };
  // Scale must not change intensities nor directions.
  builder.add_node({{"translation", {1, 2, 3}}, {"scale", {7, 7, 7}}, {"extensions", light_node(0)}});
  // Half a turn about x: -z becomes +z. Then a quarter about x: -z becomes ... +y.
  builder.add_node({{"rotation", {1, 0, 0, 0}}, {"extensions", light_node(1)}});
  const float s = std::sqrt(0.5F);
  builder.add_node({{"rotation", {s, 0, 0, s}}, {"scale", {0.1, 5, 2}}, {"extensions", light_node(2)}});
  builder.add_node({{"extensions", light_node(3)}});
  builder.add_node({{"extensions", light_node(4)}});
  const LoadedScene loaded = load(builder.write("lights"));
  ASSERT_EQ(loaded.scene.lights.size(), 4U);
  const auto& point = std::get<PointLight>(loaded.scene.lights[0]);
  EXPECT_EQ(point.position, V3f(1, 2, 3));
  EXPECT_EQ(point.intensity_cd, Rgb(8, 4, 2));
  EXPECT_TRUE(has_warning(loaded, "range"));
  const auto& spot = std::get<SpotLight>(loaded.scene.lights[1]);
  EXPECT_LT((spot.direction - V3f(0, 0, 1)).length(), 1e-6F);
  EXPECT_EQ(spot.intensity_cd, Rgb(5, 5, 5));
  EXPECT_EQ(spot.inner_angle_rad, 0.1F);
  EXPECT_EQ(spot.outer_angle_rad, 0.2F);
  // A quarter turn about +x carries -z to +y (right hand: y to z, z to -y, -z to y).
  const auto& sun = std::get<DirectionalLight>(loaded.scene.lights[2]);
  EXPECT_LT((sun.direction - V3f(0, 1, 0)).length(), 1e-6F);
  EXPECT_EQ(sun.illuminance_lux, Rgb(1000, 1000, 1000));
  const auto& plain = std::get<SpotLight>(loaded.scene.lights[3]);
  EXPECT_EQ(plain.direction, V3f(0, 0, -1));
  EXPECT_EQ(plain.outer_angle_rad, pi / 4);
  EXPECT_EQ(plain.intensity_cd, Rgb(1, 1, 1));
  EXPECT_TRUE(has_warning(loaded, "unknown type 'area'"));
}

TEST(GltfCameras, AreRigidWhateverTheirNodesScale) {
  GltfBuilder builder;
  builder.root["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0}, {"zfar", 10}}}}};
  const float s = std::sqrt(0.5F);
  const int child = builder.add_node({{"camera", 0}, {"translation", {0, 0, 1}}}, false);
  builder.add_node({{"rotation", {0, s, 0, s}}, {"scale", {4, 2, 3}}, {"children", {child}}});
  builder.add_node({{"camera", 1}, {"scale", {-1, 1, 1}}});
  const Scene scene = load(builder.write("cameras")).scene;
  ASSERT_EQ(scene.cameras.size(), 2U);
  const Camera& first = scene.cameras[0];
  EXPECT_TRUE(first.perspective);
  EXPECT_EQ(first.yfov_rad, 0.7F);
  // z = 1, scaled by 3, turned a quarter about y: at x = 3, looking along -x.
  EXPECT_LT((V3f(0, 0, 0) * first.to_world - V3f(3, 0, 0)).length(), 1e-5F);
  EXPECT_LT((V3f(0, 0, -1) * first.to_world - V3f(2, 0, 0)).length(), 1e-5F);
  EXPECT_NEAR(first.to_world.determinant(), 1, 1e-5);
  EXPECT_FALSE(scene.cameras[1].perspective);
  EXPECT_EQ(scene.cameras[1].ymag_m, 2);
  EXPECT_NEAR(scene.cameras[1].to_world.determinant(), 1, 1e-5);
}

TEST(GltfNodes, InvisibleOnesCastNothing) {
  GltfBuilder builder;
  builder.use_extension("KHR_node_visibility");
  const int mesh = builder.add_triangle_mesh();
  const int child =
      builder.add_node({{"mesh", mesh}, {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}}, false);
  builder.add_node(
      {{"mesh", mesh}, {"children", {child}}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}});
  builder.add_node({{"mesh", mesh}});
  EXPECT_EQ(load(builder.write("visibility")).scene.instances.size(), 1U);
}

TEST(GltfNodes, OnlyTheDefaultSceneIsTaken) {
  GltfBuilder builder;
  const int mesh = builder.add_triangle_mesh();
  builder.add_node({{"mesh", mesh}});
  const int other = builder.add_node({{"mesh", mesh}, {"translation", {5, 0, 0}}}, false);
  builder.root["scenes"].push_back({{"nodes", {other}}});
  EXPECT_EQ(load(builder.write("scene_0")).scene.instances.at(0).to_world[3][0], 0);
  builder.root["scene"] = 1;
  EXPECT_EQ(load(builder.write("scene_1")).scene.instances.at(0).to_world[3][0], 5);
  builder.root.erase("scene");
  EXPECT_EQ(load(builder.write("scene_none")).scene.instances.at(0).to_world[3][0], 0);
}

}  // namespace
}  // namespace ivory
