// Objects that turn and grow, under skies that turn: the viewer beside ivory render and beside files that say the same.
#include <cmath>
#include <fstream>

#include "grid/base/placement.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/view_command.h"
#include "tools/view/world/path.h"
#include "tracer/image/compare.h"

namespace ivory {
namespace {

using Json = nlohmann::json;

// Half the angle of a quaternion about +Y.
Json about_y(double degrees) {
  const double half = degrees * double(pi) / 360;
  return {0, std::sin(half), 0, std::cos(half)};
}

class TurnedObjects : public ViewCommand {
 protected:
  // A floor, a lamp above it, and a tilted wedge on a node "thing", placed as `node` says. The lamp is punctual, or, so
  // that an emissive surface moves, the wedge's own top shines.
  static std::string write(const std::string& name, const Json& node, bool shining = false) {
    GltfBuilder gltf;
    gltf.use_extension("KHR_materials_specular");
    const auto matt = [&](const Json& color) {
      gltf.root["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorFactor", color}, {"metallicFactor", 0}}},
                                        {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}},
                                        {"doubleSided", true}});
      return int(gltf.root["materials"].size()) - 1;
    };
    const int floor_color = matt({0.7, 0.7, 0.7, 1});
    const int color = matt({0.8, 0.4, 0.2, 1});
    if (shining) gltf.root["materials"][color]["emissiveFactor"] = {1, 0.8, 0.6};
    const int quad = gltf.add_indices({0, 1, 2, 0, 2, 3});
    const int floor = gltf.add(std::vector<V3f>{{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}});
    const int wedge = gltf.add_indices({0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0});
    const int corners =
        gltf.add(std::vector<V3f>{{-0.5F, 0.1F, -0.3F}, {0.9F, 0.2F, -0.2F}, {0, 0.15F, 0.6F}, {0.1F, 0.9F, 0}});
    gltf.add_node(
        {{"mesh",
          gltf.add_mesh({{"attributes", {{"POSITION", floor}}}, {"indices", quad}, {"material", floor_color}})}});
    Json thing = node;
    thing["name"] = "thing";
    thing["mesh"] = gltf.add_mesh({{"attributes", {{"POSITION", corners}}}, {"indices", wedge}, {"material", color}});
    gltf.add_node(thing);
    gltf.use_extension("KHR_lights_punctual");
    gltf.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "directional"}, {"intensity", shining ? 0.01 : 3.0}}};
    gltf.add_node(
        {{"rotation", {-0.65, 0.2, 0.1, 0.7263608}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    gltf.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
    gltf.add_node({{"camera", 0}, {"translation", {0.3, 3, 5}}, {"rotation", {-0.26, 0, 0, 0.9656086}}});
    return gltf.write(name);
  }
};

// The same node turned in its file and by --place, by the viewer and the renderer: shadow maps, too.
TEST_F(TurnedObjects, StandAsTheFileThatSaysSo) {
  const std::string straight = write("straight", {{"translation", {0.2, 0.1, 0}}});
  // 35 degrees about +Y and half as large again, about the node's origin, then moved.
  const std::string turned =
      write("turned", {{"translation", {0.5, 0.1, -0.4}}, {"rotation", about_y(35)}, {"scale", {1.5, 1.5, 1.5}}});
  const std::string placed = straight + " --object thing --place thing=0.3,0,-0.4,0,35,0,1.5";
  const std::string how = " --method none";
  const Film truth = film(turned + how);
  EXPECT_LT(compare_images(film(placed + how), truth).nrmse, 2e-4);  // edges by rounding
  EXPECT_GT(compare_images(film(straight + how), truth).nrmse, 0.02);
  const auto rendered = [&](const std::string& scene, const std::string& name) {
    run("render " + scene + " --method path --max-bounces 1 --samples 64 --size 160x120 -o " + path(name));
    return read_image(path(name));
  };
  const Film file = rendered(turned, "file.exr");
  EXPECT_LT(compare_images(rendered(placed, "placed.exr"), file).nrmse, 1e-4);
  // The viewer's points lie at other places of a pixel and shadow maps have texels: edges, a pixel or two wide.
  EXPECT_LT(compare_images(film(placed + how), file).nrmse, 0.02);
  const Json said = view(placed + how + " -o " + path("x.png")).at("objects").at(1);
  EXPECT_EQ(said.at("turn_deg"), Json({0, 35, 0}));
  EXPECT_EQ(said.at("scale"), 1.5);
}

// A lamp that turns and grows with its object: patches go with it, and its light with its area.
TEST_F(TurnedObjects, LightOfTheirSurfacesGoesWithThem) {
  const std::string straight = write("lamp", {{"translation", {0, 0.6, 0}}}, true);
  const std::string turned = write(
      "lamp_turned", {{"translation", {0, 0.6, 0}}, {"rotation", about_y(110)}, {"scale", {0.5, 0.5, 0.5}}}, true);
  const std::string placed = straight + " --object thing --place thing=0,0,0,0,110,0,0.5";
  const std::string how = " --method none --samples 16";
  const Film truth = film(turned + how);
  // Neither draws the same points of the surface in the same order: their mean has the noise of 16 samples.
  EXPECT_LT(compare_images(film(placed + how), truth).nrmse, 0.01);
  EXPECT_GT(compare_images(film(straight + how), truth).nrmse, 0.03);
}

TEST_F(TurnedObjects, PathsTurnAndScale) {
  const ObjectPath turn = parse_path("turn:8");
  EXPECT_NEAR(at(turn, 2).turn_deg.y, 90, 1e-4F);
  EXPECT_NEAR(at(turn, 9).turn_deg.y, 45, 1e-4F);
  EXPECT_EQ(at(turn, 3).offset_m, V3f(0, 0, 0));
  std::ofstream(path("k.csv")) << "t,x,y,z,rx,ry,rz,scale\n0,0,0,0,0,0,0,1\n2,1,0,0,0,90,10,2\n4,1,0,0\n";
  const ObjectPath keys = parse_path("keys:" + path("k.csv"));
  EXPECT_LT((at(keys, 1).turn_deg - V3f(0, 45, 5)).length(), 1e-4F);
  EXPECT_NEAR(at(keys, 1).scale, 1.5F, 1e-6F);
  EXPECT_NEAR(at(keys, 3).scale, 1.5F, 1e-6F);
  const std::string scene = write("path", Json::object());
  const Json result =
      view(scene + " --method none --samples 1 --frames 3 --fps 1 --object thing --path turn:8 -o " + path("f.png"));
  EXPECT_EQ(result.at("objects").at(1).at("turn_deg"), Json({0, 90, 0}));
  std::ofstream(path("bad.csv")) << "0,0,0,0,0,0,0,0\n1,0,0,0,0,0,0,1\n";
  expect_one_line(
      "view --headless " + scene + " --object thing --path keys:" + path("bad.csv") + " -o " + path("x.png"), 1,
      "scale");
}

TEST_F(TurnedObjects, PlacesThatSayNothingAreRefused) {
  const std::string scene = write("refused", Json::object());
  for (const std::string command : {"view --headless ", "render --method path --samples 1 --size 16x12 "}) {
    const std::string to = " -o " + path("x.png");
    expect_one_line(command + scene + " --object thing --place other=1,2,3" + to, 2, "no object 'other'");
    expect_one_line(command + scene + " --object thing --place thing=1,2,3,4" + to, 2, "RX,RY,RZ");
    expect_one_line(command + scene + " --object thing --place thing=0,0,0,0,0,0,-1" + to, 2, "scale");
    expect_one_line(command + scene + " --object thing --place thing" + to, 2, "OBJECT=X,Y,Z");
  }
}

class TurnedSky : public TurnedObjects {};

TEST_F(TurnedSky, IsTheTurnedMap) {
  const std::string scene = write("under_sky", {{"translation", {0, 0.1, 0}}});
  const std::string now = small_sky("now.hdr", 0);
  // A turn takes what stood at column c + 8 to column c: a quarter of a turn.
  const std::string map = small_sky("map.hdr", 8);
  const std::string by_turn = scene + " --env " + now + " --env-turn 90";
  const std::string by_map = scene + " --env " + map;
  const auto rendered = [&](const std::string& arguments, const std::string& name) {
    run("render " + arguments + " --method path --max-bounces 1 --samples 32 --size 80x60 -o " + path(name));
    return read_image(path(name));
  };
  const Film truth = rendered(by_map, "map.exr");
  EXPECT_TRUE(rendered(by_turn, "turn.exr").pixels == truth.pixels);
  // Every source in the viewer: small lights with their shadow maps and the background; DifMaps made at the start; SH9
  // from a file.
  run("bake sh9 " + now + " --order 2 -o " + path("s.json"));
  run("bake sh9 " + map + " --order 2 -o " + path("s_map.json"));
  struct Case {
    std::string method, asset, asset_of_map;
  };
  for (const Case& c :
       {Case{"none", "", ""}, Case{"difmap", "", ""}, Case{"sh9", path("s.json"), path("s_map.json")}}) {
    const std::string how = " --samples 2 --method " + c.method;
    const Film turned = small(by_turn + how + " " + c.asset);
    const Film expected = small(by_map + how + " " + c.asset_of_map);
    // Small lights are drawn of the environment's own points, which a turned map has others of.
    EXPECT_LT(compare_images(turned, expected).nrmse, c.method == "none" ? 0.03 : 2e-3) << c.method << c.asset;
    if (c.method != "difmap" || !c.asset.empty()) continue;
    EXPECT_GT(compare_images(small(scene + " --env " + now + how), expected).nrmse, 0.03);
  }
  // Sun, shadow and all: the viewer beside the renderer.
  EXPECT_LT(compare_images(small(by_turn + " --method none --samples 4"), truth).nrmse, 0.08);  // edges
}

TEST_F(TurnedSky, IsSaidWhereAssetsKeepTheOldOne) {
  const std::string scene = write("old_sky", Json::object());
  const std::string now = small_sky("now.hdr", 0);
  run("bake grid " + scene + " --env " + now + " --resolution 6 --photons 20k -o " + path("g.vdb"));
  const std::string viewed = "view --headless --samples 1 --size 32x24 --force --frames 3 " + scene + " --env " + now +
                             " " + path("g.vdb") + " -o " + path("x.png");
  const RunResult said = run_ivory(viewed + " --env-turn 30");
  EXPECT_EQ(said.exit_code, 0) << said.output;
  const std::size_t at = said.output.find("keeps the light of the environment");
  ASSERT_NE(at, std::string::npos) << said.output;
  EXPECT_EQ(said.output.find("keeps the light", at + 9), std::string::npos) << said.output;  // once
  EXPECT_EQ(run_ivory(viewed).output.find("keeps the light"), std::string::npos);
  // The renderer refuses what it is not told to mix up; baked under the same turn all is well.
  const std::string rendered = "render --method direct --samples 1 --size 32x24 --force " + scene + " --env " + now +
                               " --env-turn 30 -o " + path("x.exr") + " --grid ";
  expect_one_line(rendered + path("g.vdb"), 1, "--env-turn 0");
  run("bake grid " + scene + " --env " + now + " --env-turn 30 --resolution 6 --photons 20k -o " + path("t.vdb"));
  EXPECT_EQ(run("info " + path("t.vdb")).at("environment_turn_deg"), 30);
  run(rendered + path("t.vdb"));
}

}  // namespace
}  // namespace ivory
