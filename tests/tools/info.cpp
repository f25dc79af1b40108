// ivory info: what it says of scenes and of what was assumed when an asset was made.
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/command_test.h"
#include "tests/support/gltf_builder.h"

namespace ivory {
namespace {

using nlohmann::json;

class InfoCommand : public CommandTest {
 protected:
  // A floor of 10 m, and that light 2 m above it.
  std::string lit_by(const json& light) const {
    GltfBuilder builder;
    const int p = builder.add({{-5, 0, 5}, {5, 0, 5}, {0, 0, -5}});
    builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", p}}}})}});
    builder.use_extension("KHR_lights_punctual");
    builder.root["extensions"]["KHR_lights_punctual"]["lights"] = json::array({light});
    builder.add_node({{"translation", {0, 2, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    return builder.write("scene");
  }
  static std::string hints_of(const std::string& file) { return run("info " + file).at("hints").dump(); }
};

TEST_F(InfoCommand, SaysWhatLightsAmountTo) {
  const json found = run("info " + lit_by({{"type", "point"}, {"intensity", 100}, {"color", {1, 0.5, 0.25}}}));
  ASSERT_EQ(found.at("lights").size(), 1U);
  const json& light = found["lights"][0];
  EXPECT_EQ(light.at("type"), "point");
  EXPECT_EQ(light.at("intensity_cd"), json({100.0, 50.0, 25.0}));
  EXPECT_NEAR(light.at("power_lm")[0].get<double>(), 4 * 3.14159265 * 100, 0.01);
  EXPECT_EQ(light.at("position_m"), json({0.0, 2.0, 0.0}));
  EXPECT_EQ(found.at("hints"), json::array());
  EXPECT_NE(run_ivory("info " + path("scene.glb")).output.find("light                point, 100.0 50.0 25.0 cd"),
            std::string::npos);
}

// 1,000 W of a Blender lamp, by 683 lm/W over the sphere; and as the sun is to the brightest noon.
TEST_F(InfoCommand, HintsAtWattsTurnedIntoCandela) {
  EXPECT_NE(hints_of(lit_by({{"type", "point"}, {"intensity", 54351.4}})).find("683 lm/W"), std::string::npos);
  EXPECT_NE(hints_of(lit_by({{"type", "directional"}, {"intensity", 683'000}})).find("1000 lux"), std::string::npos);
  EXPECT_EQ(hints_of(lit_by({{"type", "directional"}, {"intensity", 100'000}})), "[]");
}

TEST_F(InfoCommand, HintsAtLampsInsideTheirModels) {
  for (const bool open : {false, true}) {
    GltfBuilder builder;
    const int floor = builder.add({{-5, 0, 5}, {5, 0, 5}, {0, 0, -5}});
    builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", floor}}}})}});
    // A tetrahedron of 10 cm about the lamp, or three faces of it.
    std::vector<V3f> corners;
    const V3f c[4] = {{0.1F, 0.1F, 0.1F}, {-0.1F, -0.1F, 0.1F}, {-0.1F, 0.1F, -0.1F}, {0.1F, -0.1F, -0.1F}};
    for (const auto& face : {std::array{0, 1, 2}, std::array{0, 3, 1}, std::array{0, 2, 3}, std::array{1, 3, 2}}) {
      if (open && corners.size() == 9) break;
      for (const int corner : face) corners.push_back(c[corner]);
    }
    const int bulb = builder.add_mesh({{"attributes", {{"POSITION", builder.add(corners)}}}});
    builder.use_extension("KHR_lights_punctual");
    builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 100}}};
    builder.add_node(
        {{"mesh", bulb}, {"translation", {0, 2, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    builder.write("lamp");
    EXPECT_EQ(hints_of(path("lamp.glb")).find("inside geometry") != std::string::npos, !open) << open;
  }
}

TEST_F(InfoCommand, HintsAtScenesWithoutLight) {
  GltfBuilder builder;
  builder.add_node({{"mesh", builder.add_triangle_mesh()}});
  builder.write("dark");
  EXPECT_NE(hints_of(path("dark.glb")).find("nothing shines"), std::string::npos);
}

// Once each, without the folders that the inputs lie in.
TEST_F(InfoCommand, AssetsKeepWhatWasAssumed) {
  const std::string room = lit_by({{"type", "point"}, {"intensity", 100}, {"range", 5}});
  run("bake grid " + room + " -o " + path("room.vdb") + " --resolution 4 --photons 2k");
  const json expected =
      json::array({"scene.glb: lights[0] has a range, which is ignored: light falls off with the square"});
  EXPECT_EQ(run("info " + path("room.vdb")).at("assumptions"), expected);
  run("bake cubemap " + room + " -o " + path("room.exr") + " --at 0,1,0 --capture 8 --size 2 --samples 1");
  json captured = expected;
  captured.push_back("(0, 1, 0) lies outside of the scene's bounds");  // the floor is flat
  EXPECT_EQ(run("info " + path("room.exr")).at("assumptions"), captured);
  run("bake spheres " + room + " -o " + path("room.json") + " --count 2");
  EXPECT_EQ(run("info " + path("room.json")).at("assumptions"), expected);
}

}  // namespace
}  // namespace ivory
