// Spherical lights and Lafortune lobes in a file's extras.
#include "tracer/gltf/extras.h"

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/gltf_builder.h"
#include "tracer/gltf/loader.h"

namespace ivory {
namespace {

TEST(GltfExtras, ReadLightsAndLafortuneLobes) {
  GltfBuilder b;
  b.root["materials"].push_back(
      {{"extras",
        {{"ivory_lafortune", {{{"k", {0.1, 0.2, 0.3}}, {"c", {-1, -1, 0.9}}, {"exponent", 12}, {"tinted", true}}}}}}});
  const int mesh =
      b.add_mesh({{"attributes", {{"POSITION", b.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})}}}, {"material", 0}});
  b.add_node({{"mesh", mesh}});
  b.add_node({{"translation", {1, 2, 3}},
              {"scale", {2, 2, 2}},
              {"extras", {{"ivory_sphere_light", {{"radius", 0.25}, {"radiance", {1, 2, 3}}}}}}});
  const Scene scene = load_gltf(b.write("extras")).scene;
  ASSERT_EQ(scene.sphere_lights.size(), 1U);
  EXPECT_EQ(scene.sphere_lights[0].center, V3f(1, 2, 3));
  EXPECT_NEAR(scene.sphere_lights[0].radius_m, 0.5F, 1e-6F);
  EXPECT_EQ(scene.sphere_lights[0].radiance_nits, Rgb(1, 2, 3));
  ASSERT_EQ(scene.materials[0].lafortune.size(), 1U);
  EXPECT_EQ(scene.materials[0].lafortune[0].exponent, 12);
  EXPECT_TRUE(scene.materials[0].lafortune[0].tinted);
}

TEST(GltfExtras, NameGroupsOfLightsAndTheNodesOfLights) {
  GltfBuilder b;
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  const int lamp =
      b.add_node({{"name", "Lamp"}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}, /*in_scene=*/false);
  b.add_node({{"mesh", b.add_triangle_mesh()}});
  b.add_node({{"children", {lamp}}, {"extras", {{"ivory_group", "hall"}}}});
  b.use_extension("KHR_lights_punctual");
  const Scene scene = load_gltf(b.write("groups")).scene;
  EXPECT_EQ(scene.light_nodes, std::vector<int>{lamp});
  EXPECT_EQ(scene.nodes[2].light_group, "hall");
  EXPECT_EQ(scene.nodes[0].light_group, "");
  b.root["nodes"][0]["extras"]["ivory_group"] = 7;
  try {
    load_gltf(b.write("groups_bad"));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("ivory_group"), std::string::npos) << error.what();
  }
}

TEST(GltfExtras, RefuseWhatMakesNoSense) {
  const auto load = [](const nlohmann::json& light, const nlohmann::json& lobes) {
    GltfBuilder b;
    nlohmann::json material = nlohmann::json::object();
    if (!lobes.is_null()) material["extras"]["ivory_lafortune"] = lobes;
    b.root["materials"].push_back(material);
    b.add_node({{"mesh", b.add_triangle_mesh()}});
    if (!light.is_null()) b.add_node({{"extras", {{"ivory_sphere_light", light}}}});
    load_gltf(b.write("bad_extras"));
  };
  EXPECT_NO_THROW(load(nullptr, nullptr));
  for (const nlohmann::json& light :
       {nlohmann::json(3), nlohmann::json({{"radius", 1}}), nlohmann::json({{"radius", 0}, {"radiance", {1, 1, 1}}}),
        nlohmann::json({{"radius", "1"}, {"radiance", {1, 1, 1}}}),
        nlohmann::json({{"radius", 1}, {"radiance", {1, 1}}}),
        nlohmann::json({{"radius", 1}, {"radiance", {1, -1, 1}}}),
        nlohmann::json({{"radius", 1e300}, {"radiance", {1, 1, 1}}})})
    EXPECT_THROW(load(light, nullptr), Error) << light;
  for (const nlohmann::json& lobes : {nlohmann::json(1), nlohmann::json::array(), nlohmann::json({1}),
                                      nlohmann::json({{{"k", {1, 1, 1}}, {"c", {1, 1, 1}}, {"exponent", -1}}}),
                                      nlohmann::json({{{"k", {1, 1, 1}}, {"c", {1, 1, 1}}}}),
                                      nlohmann::json({{{"k", {1, 1, 1}}, {"c", {9, 1, 1}}, {"exponent", 100}}}),
                                      nlohmann::json({{{"k", {-1, 1, 1}}, {"c", {1, 1, 1}}, {"exponent", 1}}})})
    EXPECT_THROW(load(nullptr, lobes), Error) << lobes;
}

}  // namespace
}  // namespace ivory
