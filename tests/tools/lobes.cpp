// ivory bake lobes, bake spheres and render --method lobes as a script meets them.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command_test.h"
#include "tests/support/gltf_builder.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

class LobesCommand : public CommandTest {
 protected:
  static nlohmann::json result_of(const std::string& arguments) {
    const RunResult run = run_ivory(arguments + " --json --quiet", false);
    EXPECT_EQ(run.exit_code, 0) << arguments;
    return nlohmann::json::parse(run.output, nullptr, false);
  }
  // A matt floor 4 m wide and a box (0.6 m, 0.5 to 1.1 m high) above it; light and camera come from elsewhere.
  std::string scene() const {
    GltfBuilder b;
    b.root["materials"].push_back(
        {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorFactor", {0.8, 0.8, 0.8, 1}}}},
         {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}});
    b.use_extension("KHR_materials_specular");
    const int floor =
        b.add_mesh({{"attributes", {{"POSITION", b.add({{-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}})}}},
                    {"indices", b.add_indices({0, 1, 2, 0, 2, 3})},
                    {"material", 0}});
    std::vector<V3f> corners;
    for (int i = 0; i < 8; ++i)
      corners.emplace_back((i & 1) != 0 ? 0.3F : -0.3F, (i & 2) != 0 ? 1.1F : 0.5F, (i & 4) != 0 ? 0.3F : -0.3F);
    const int box = b.add_mesh({{"attributes", {{"POSITION", b.add(corners)}}},
                                {"indices", b.add_indices({0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                                           2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6})},
                                {"material", 0}});
    b.add_node({{"mesh", floor}});
    b.add_node({{"mesh", box}, {"name", "box"}});
    // Down on the floor, the light out of the picture.
    b.root["cameras"].push_back({{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
    b.add_node({{"camera", 0}, {"matrix", {0, 0, 1, 0, 0.588, 0.809, 0, 0, -0.809, 0.588, 0, 0, -2.2, 1.6, 0, 1}}});
    return b.write("lobes_scene");
  }
  // The box alone.
  std::string box() const {
    GltfBuilder b;
    std::vector<V3f> corners;
    for (int i = 0; i < 8; ++i)
      corners.emplace_back((i & 1) != 0 ? 0.3F : -0.3F, (i & 2) != 0 ? 0.3F : -0.3F, (i & 4) != 0 ? 0.3F : -0.3F);
    b.add_node(
        {{"mesh", b.add_mesh({{"attributes", {{"POSITION", b.add(corners)}}},
                              {"indices", b.add_indices({0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                                         2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6})}})}});
    return b.write("lobes_box");
  }
};

const std::string light = " --sphere-light 0.6,2.6,0.4,0.35,10,10,10 ";

TEST_F(LobesCommand, BakesATableThatInfoDescribes) {
  const auto result = result_of("bake lobes -o " + path("lobes.exr") + " --error-samples 20k");
  EXPECT_LT(result["integral_error"]["mean"], 7.1e-4);  // the report's
  EXPECT_LT(result["integral_error"]["worst"], 0.05);
  EXPECT_LT(result["bytes"], 10'000'000);
  const auto info = result_of("info " + path("lobes.exr"));
  EXPECT_EQ(info["kind"], "lobes");
  EXPECT_EQ(info["exponent_nodes"], 33);
  EXPECT_EQ(info["integral_error_mean"], result["integral_error"]["mean"]);
}

TEST_F(LobesCommand, ShadowsOfSpheresComeNearThePathTracersOfTheMesh) {
  ASSERT_EQ(result_of("bake spheres " + box() + " -o " + path("box.json") + " --count 64")["count"], 64);
  const std::string common = "render " + scene() + light + "--size 48x36 --threads 2 --force --samples ";
  result_of(common + "1024 --method path --max-bounces 1 -o " + path("path.exr"));
  result_of(common + "64 --method lobes --spheres " + path("box.json") + "@0,0.8,0 -o " + path("lobes.exr"));
  result_of(common + "64 --method lobes --shadows mesh --shadow-rays 16 -o " + path("mesh.exr"));
  const auto none = result_of(common + "64 --method lobes --shadows none -o " + path("none.exr"));
  // The picture alone; the table of lobes, made before it, takes longer than nothing.
  EXPECT_GT(none["render_seconds"], 0);
  EXPECT_LT(none["render_seconds"], none["seconds"]);
  const auto error = [&](const char* name) {
    return result_of("compare " + path(name) + " " + path("path.exr"))["nrmse"].get<double>();
  };
  // The twin on the mesh is the path tracer's picture but for noise; spheres add the fit of a cube's corners.
  EXPECT_LT(error("mesh.exr"), 0.01);
  EXPECT_LT(error("lobes.exr"), 0.04);
  EXPECT_GT(error("none.exr"), 0.06);
}

TEST_F(LobesCommand, SameBytesAtAnyNumberOfThreads) {
  const std::string mesh = box();
  for (const char* threads : {"1", "2"}) {
    const std::string t = std::string(" --threads ") + threads + " ";
    result_of("bake spheres " + mesh + " -o " + path(std::string("s") + threads + ".json") + " --count 12" + t);
    result_of("render " + scene() + light + "--size 32x24 --samples 2 --method lobes --spheres " + path("s1.json") + t +
              "-o " + path(std::string("i") + threads + ".exr"));
  }
  EXPECT_EQ(bytes_of(path("s1.json")), bytes_of(path("s2.json")));
  EXPECT_EQ(bytes_of(path("i1.exr")), bytes_of(path("i2.exr")));
}

TEST_F(LobesCommand, BadInputEndsInOneLine) {
  const std::string mesh = scene();
  result_of("bake spheres " + box() + " -o " + path("box.json") + " --count 2");
  GltfBuilder::write_file(path("broken.json"), "{\"ivory_asset\": \"spheres\"");
  GltfBuilder::write_file(path("note.txt"), "hello");
  struct Case {
    std::string arguments;
    int exit_code;
  };
  const std::string render = "render " + mesh + " -o " + path("x.exr") + " --size 8x8 --samples 1 --method lobes ";
  for (const Case& c : {Case{"bake lobes -o " + path("x.png"), 2},
                        Case{"bake lobes -o " + path("x.exr") + " --exponent-nodes 1", 2},
                        Case{"bake lobes -o " + path("absent/x.exr"), 1},
                        Case{"bake lobes -o " + path("x.exr") + " --error-samples 0", 2},
                        Case{"bake spheres " + mesh + " -o " + path("x.txt"), 2},
                        Case{"bake spheres " + mesh + " -o " + path("x.json") + " --count 0", 2},
                        Case{"bake spheres " + mesh + " -o " + path("x.json") + " --count 1g", 2},
                        Case{"bake spheres " + path("note.txt") + " -o " + path("x.json"), 1},
                        Case{"bake spheres " + path("absent.glb") + " -o " + path("x.json"), 1},
                        Case{"bake spheres " + box() + " -o " + path("box.json"), 1},  // it exists
                        Case{render + "--quiet", 1},                                   // no light
                        Case{render + "--sphere-light 1,2,3", 2},
                        Case{render + "--sphere-light 0,2,0,-1,1,1,1", 1},
                        Case{render + "--sphere-light 0,2,0,nan,1,1,1", 2},
                        Case{render + light + "--spheres " + path("broken.json"), 1},
                        Case{render + light + "--spheres " + path("absent.json"), 1},
                        Case{render + light + "--spheres " + path("box.json") + "@1,2", 2},
                        Case{render + light + "--lobes " + path("box.json"), 1},
                        Case{render + light + "--mask-depth 6", 2},
                        Case{render + light + "--shadow-rays 0", 2},
                        Case{render + light + "--indirect-only", 2},
                        Case{"info " + path("broken.json"), 1}}) {
    const RunResult run = run_ivory(c.arguments);
    EXPECT_EQ(run.exit_code, c.exit_code) << c.arguments << "\n" << run.output;
    EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 1) << c.arguments << "\n" << run.output;
  }
  EXPECT_FALSE(fs::exists(path("x.exr")));
  EXPECT_FALSE(fs::exists(path("x.json")));
}

}  // namespace
}  // namespace ivory
