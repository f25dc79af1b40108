// Lights, cameras and nodes of glTF files.
#include <algorithm>
#include <cmath>
#include <limits>

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

// Angles as exporters write them, with a word each.
TEST(GltfLights, SpotAnglesAreMended) {
  GltfBuilder builder;
  builder.use_extension("KHR_lights_punctual");
  const auto spot = [](double inner, double outer) {
    return json{{"type", "spot"}, {"spot", {{"innerConeAngle", inner}, {"outerConeAngle", outer}}}};
  };
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      spot(0.5, 0.5), spot(0.9, 0.5), spot(0.2, 2.5), spot(3, 2.5), spot(0, 0), spot(0, 1.5707963267948966)};
  for (int i = 0; i < 6; ++i) builder.add_node({{"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  const LoadedScene loaded = load(builder.write("spots"));
  ASSERT_EQ(loaded.scene.lights.size(), 5U);
  const float expected[5][2] = {{0.5F, 0.5F}, {0.5F, 0.5F}, {0.2F, pi / 2}, {pi / 2, pi / 2}, {0, pi / 2}};
  for (std::size_t i = 0; i < 5; ++i) {
    const auto& light = std::get<SpotLight>(loaded.scene.lights[i]);
    EXPECT_EQ(light.inner_angle_rad, expected[i][0]) << i;
    EXPECT_EQ(light.outer_angle_rad, expected[i][1]) << i;
  }
  for (const char* word : {"lights[0] has an inner cone equal to", "lights[1] has an inner cone wider than",
                           "lights[2] has an outer cone of 2.5 rad", "lights[3] has an outer cone of 2.5 rad",
                           "lights[4] has a cone without width"})
    EXPECT_TRUE(has_warning(loaded, word)) << word;
  EXPECT_EQ(loaded.warnings.size(), 7U);  // lights[3] has both, and there are no triangles
  builder.root["extensions"]["KHR_lights_punctual"]["lights"][0] = spot(-0.1, 0.5);
  EXPECT_NE(error_of(builder, "negative").find("innerConeAngle is -0.1"), std::string::npos);
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
  EXPECT_EQ(first.near_m, 0.1F);
  EXPECT_EQ(first.far_m, std::numeric_limits<float>::infinity());
  EXPECT_FALSE(scene.cameras[1].perspective);
  EXPECT_EQ(scene.cameras[1].ymag_m, 2);
  EXPECT_EQ(scene.cameras[1].far_m, 10);
  LoadParams millimetres;
  millimetres.scale = 0.001;
  const Scene small = load(builder.write("cameras"), millimetres).scene;
  EXPECT_FLOAT_EQ(small.cameras[0].near_m, 1e-4F);
  EXPECT_FLOAT_EQ(small.cameras[1].far_m, 0.01F);
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

// By name (all that are called so) or index; lights below go too, cameras and the file's content hash stay.
TEST(GltfNodes, SomeAreLeftOutOnRequest) {
  GltfBuilder builder;
  builder.use_extension("KHR_lights_punctual");
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  builder.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
  // One pixel, in a file of its own, which is part of the content.
  constexpr std::uint8_t png[] = {0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48,
                                  0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00,
                                  0x00, 0x1F, 0x15, 0xC4, 0x89, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x44, 0x41, 0x54, 0x78,
                                  0xDA, 0x63, 0xFC, 0xCF, 0xC0, 0x50, 0x0F, 0x00, 0x04, 0x85, 0x01, 0x80, 0x84, 0xA9,
                                  0x8C, 0x21, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};
  GltfBuilder::write_file(GltfBuilder::folder() + "/pixel.png", std::string(std::begin(png), std::end(png)));
  builder.root["images"] = {{{"uri", "pixel.png"}}};
  builder.root["textures"] = {{{"source", 0}}};
  builder.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  const int mesh = builder.add_triangle_mesh();
  const int textured = builder.add_triangle_mesh();
  json& primitive = builder.root["meshes"][std::size_t(textured)]["primitives"][0];
  primitive["material"] = 0;
  primitive["attributes"]["TEXCOORD_0"] = builder.add(std::vector<V2f>(3));
  const int lamp = builder.add_node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}, {"camera", 0}}, false);
  builder.add_node({{"name", "car"}, {"mesh", textured}, {"children", {lamp}}});
  builder.add_node({{"name", "car"}, {"mesh", mesh}, {"translation", {5, 0, 0}}});
  builder.add_node({{"name", "house"}, {"mesh", mesh}, {"translation", {9, 0, 0}}});
  const std::string path = builder.write("without");
  const auto without = [&](const std::vector<std::string>& names) {
    LoadParams params;
    params.without = names;
    return load(path, params).scene;
  };
  const Scene whole = without({});
  EXPECT_EQ(whole.instances.size(), 3U);
  EXPECT_EQ(whole.lights.size(), 1U);
  const Scene house = without({"car"});
  ASSERT_EQ(house.instances.size(), 1U);
  EXPECT_EQ(house.instances[0].to_world[3][0], 9);
  EXPECT_TRUE(house.lights.empty());
  EXPECT_EQ(house.cameras.size(), 1U);
  EXPECT_EQ(house.content_hash, whole.content_hash);
  EXPECT_EQ(without({"3", "house"}).instances.size(), 2U) << "node 3 is the house";
  EXPECT_EQ(without({"0"}).lights.size(), 0U);
  EXPECT_EQ(without({"0"}).instances.size(), 3U);
  for (const char* nobody : {"nobody", "", "4", "-1", "1x"}) EXPECT_THROW(without({nobody}), ParameterError) << nobody;
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
