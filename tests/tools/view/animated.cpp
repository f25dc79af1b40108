// Animations that play and lamps that change, in the viewer.
#include <cmath>
#include <filesystem>
#include <functional>

#include "tests/support/gltf_builder.h"
#include "tests/support/view_command.h"
#include "tracer/image/compare.h"

namespace ivory {
namespace {

using Json = nlohmann::json;

class ViewAnimation : public ViewCommand {
 protected:
  // A floor, a wedge that slides and turns within two seconds, a lamp that crosses it, a camera.
  static std::string write(const std::string& name, const std::function<void(Json& root)>& change = {}) {
    GltfBuilder gltf;
    gltf.root["materials"].push_back({{"pbrMetallicRoughness", {{"metallicFactor", 0}}}, {"doubleSided", true}});
    const auto mesh = [&](const std::vector<V3f>& corners, const std::vector<std::uint16_t>& triangles) {
      const int indices = gltf.add_indices(triangles);
      return gltf.add_mesh({{"attributes", {{"POSITION", gltf.add(corners)}}}, {"indices", indices}, {"material", 0}});
    };
    gltf.add_node({{"mesh", mesh({{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}}, {0, 1, 2, 0, 2, 3})}});
    const int thing =
        gltf.add_node({{"name", "thing"},
                       {"mesh", mesh({{-0.5F, 0.1F, -0.3F}, {0.9F, 0.2F, -0.2F}, {0, 0.15F, 0.6F}, {0.1F, 0.9F, 0}},
                                     {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0})}});
    gltf.use_extension("KHR_lights_punctual");
    gltf.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 60}},
                                                                {{"type", "point"}, {"intensity", 20}}};
    const auto lamp = [&](const std::string& node, int light, const Json& place) {
      return gltf.add_node(
          {{"name", node}, {"translation", place}, {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
    };
    const int moving = lamp("lamp", 0, {-2, 2, 1});
    lamp("other", 1, {2, 2, 2});
    gltf.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
    gltf.add_node({{"camera", 0}, {"translation", {0.3, 3, 5}}, {"rotation", {-0.26, 0, 0, 0.9656086}}});
    const int times = gltf.add_accessor("SCALAR", 5126, 2, gltf.add_view(std::vector<float>{0, 2}.data(), 8));
    gltf.root["accessors"][times]["min"] = {0};
    gltf.root["accessors"][times]["max"] = {2};
    const int slide = gltf.add(std::vector<V3f>{{0, 0, 0}, {1, 0.2F, -1}});
    const int turn = gltf.add(std::vector<V4f>{{0, 0, 0, 1}, {0, 0.8F, 0, 0.6F}});
    const int cross = gltf.add(std::vector<V3f>{{-2, 2, 1}, {2, 2, 1}});
    Json samplers = Json::array();
    for (const int output : {slide, turn, cross}) samplers.push_back({{"input", times}, {"output", output}});
    const auto channel = [](int sampler, int node, const char* path) {
      return Json{{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}};
    };
    gltf.root["animations"] = {
        {{"name", "go"},
         {"samplers", samplers},
         {"channels",
          {channel(0, thing, "translation"), channel(1, thing, "rotation"), channel(2, moving, "translation")}}}};
    if (change) change(gltf.root);
    return gltf.write(name);
  }
};

// A frame of what plays is, to the bit, the picture of the scene loaded at its time; the lamp, its shadow maps and a
// node that is an object go along.
TEST_F(ViewAnimation, PlaysWhatTimeShows) {
  const std::string scene = write("plays");
  for (const std::string objects : {"", " --object thing --place thing=0.2,0,0,0,30,0"}) {
    const std::string how = "view --headless --method none --samples 2 --size 80x60 --force " + scene + objects;
    run(how + " --play --frames 4 --fps 2 -o " + path("f_%d.exr"));
    for (const int i : {1, 3}) {
      run(how + " --time " + std::to_string(0.5 * i) + " -o " + path("t.exr"));
      EXPECT_TRUE(read_image(path("f_" + std::to_string(i) + ".exr")).pixels == read_image(path("t.exr")).pixels) << i;
    }
    EXPECT_GT(compare_images(read_image(path("f_3.exr")), read_image(path("f_0.exr"))).nrmse, 0.03);
  }
  expect_one_line("view --headless --play " + room() + " -o " + path("x.png"), 2, "has no animation");
}

// Skins, morphs and nodes of the sample files, as ivory render has them at that time.
TEST_F(ViewAnimation, PosesAreThoseOfRender) {
  const char* data = std::getenv("IVORY_DATA");
  if (data == nullptr) GTEST_SKIP() << "IVORY_DATA names no folder of sample data (CONTRIBUTING.md)";
  const std::filesystem::path folder = std::filesystem::path(data) / "animated";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const std::string sky = " --env " + small_sky("sky.hdr", 0);
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string file = entry.path().string();
    if (!file.ends_with(".gltf") && !file.ends_with(".glb")) continue;
    ++files;
    const std::string common = file + " --time 0.8" + sky + " --size 160x120 --force ";
    run("view --headless --method difmap --samples 16 " + common + "-o " + path("v.exr"));
    // Without occluders the same light, and no noise but that of the pixels' points.
    run("render --method fiv --samples 32 " + common + "-o " + path("r.exr"));
    const Film seen = read_image(path("v.exr"));
    const Film truth = read_image(path("r.exr"));
    float white = 0;
    for (const Rgb& pixel : truth.pixels) white = std::max(white, luminance(pixel));
    std::size_t differ = 0;
    for (std::size_t i = 0; i < truth.pixels.size(); ++i)
      differ += std::abs(luminance(seen.pixels[i]) - luminance(truth.pixels[i])) > 0.1F * white ? 1 : 0;
    EXPECT_LE(differ, truth.pixels.size() / 100) << file;
  }
  EXPECT_GE(files, 6);
}

TEST_F(ViewAnimation, LampsShineAsTheyAreTold) {
  const std::string scene = write("lamps");
  const auto lights = [](Json& root) -> Json& { return root["extensions"]["KHR_lights_punctual"]["lights"]; };
  const std::string how = " --method none --samples 2";
  const Film plain = small(scene + how);
  const std::string dim = write("dim", [&](Json& root) {
    lights(root)[0]["intensity"] = 30;
    lights(root)[0]["color"] = {1, 0.5, 0.25};
    for (Json& node : root["nodes"]) {
      if (node.contains("name") && node["name"] == "lamp") node["translation"] = {-1, 2.5, 1};
    }
  });
  const Film told = small(scene + how + " --lamp lamp=0.5,1,0.5,0.25,1,0.5,0");
  EXPECT_LT(compare_images(told, small(dim + how)).nrmse, 1e-5);
  EXPECT_GT(compare_images(told, plain).nrmse, 0.02);
  const std::string off = write("off", [&](Json& root) { lights(root)[0]["intensity"] = 0; });
  EXPECT_TRUE(small(scene + how + " --lamp lamp=0").pixels == small(off + how).pixels);
  EXPECT_TRUE(small(scene + how + " --lamp lamp=1").pixels == plain.pixels);
  const std::string refused = "view --headless " + scene + " -o " + path("x.png") + " --lamp ";
  expect_one_line(refused + "lantern=1", 2, "lamp, other");
  expect_one_line(refused + "lamp=-1", 2, "brightness");
  expect_one_line(refused + "lamp=1,2", 2, "R,G,B");
}

}  // namespace
}  // namespace ivory
