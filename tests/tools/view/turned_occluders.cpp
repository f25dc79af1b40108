// FIV occluders that turn, by the viewer and the renderer: a set of turns beside tables of the turned mesh.
#include <cmath>

#include "grid/base/placement.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/view_command.h"
#include "tracer/image/compare.h"

namespace ivory {
namespace {

class TurnedOccluders : public ViewCommand {
 protected:
  // A wedge without symmetry, turned about +Y.
  static std::string write(const std::string& name, double degrees) {
    GltfBuilder gltf;
    const int indices = gltf.add_indices({0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0});
    const int corners =
        gltf.add(std::vector<V3f>{{-0.6F, 0, -0.3F}, {1, 0.1F, -0.2F}, {0, 0.05F, 0.6F}, {0.1F, 0.9F, 0}});
    gltf.root["materials"].push_back({{"pbrMetallicRoughness", {{"metallicFactor", 0}}}, {"doubleSided", true}});
    const double half = 0.5 * degrees * radians_a_degree;
    gltf.add_node(
        {{"name", "thing"},
         {"rotation", {0, std::sin(half), 0, std::cos(half)}},
         {"mesh", gltf.add_mesh({{"attributes", {{"POSITION", corners}}}, {"indices", indices}, {"material", 0}})}});
    return gltf.write(name);
  }
  std::string sky() const { return " --env " + small_sky("sky.hdr", 0); }
  std::string bake(const std::string& mesh, const std::string& out, const std::string& more = {}) const {
    run("bake fiv " + mesh + sky() + " --samples 16,9,8 --silhouette 32 --parts 256 --hemispheres 6 " + more + " -o " +
        path(out));
    return path(out);
  }
  Film viewed(const std::string& object, const std::string& table, const std::string& more = {}) const {
    return small(" --samples 4 " + scene("plaza.gltf") + sky() + " --method fiv --object " + object + " " + table +
                 " " + more);
  }
  Film rendered(const std::string& object, const std::string& table, const std::string& more = {}) const {
    run("render " + scene("plaza.gltf") + sky() + " --method fiv --samples 8 --size 80x60 --force --object " + object +
        " --occluder thing=" + table + " " + more + " -o " + path("r.exr"));
    return read_image(path("r.exr"));
  }
};

TEST_F(TurnedOccluders, StandAsTablesOfTheTurnedMeshSay) {
  const std::string thing = write("thing", 0);
  const std::string turned = write("turned", 120);
  const std::string set = bake(thing, "set.exr", "--turns 3");
  const std::string fresh = bake(turned, "fresh.exr");
  EXPECT_EQ(run("info " + set).at("turns"), 3);
  const std::string at = "@0,0.2,0";
  const Film truth = rendered(turned + at, fresh);
  // Coarse tables whose distances were chosen for the mesh unturned and turned.
  EXPECT_LT(compare_images(rendered(thing + at + ",0,120,0", set), truth).nrmse, 0.015);
  EXPECT_GT(compare_images(rendered(thing + at, set), truth).nrmse, 0.02);
  EXPECT_LT(compare_images(viewed(turned + at, fresh), truth).nrmse, 0.02);  // edges
  EXPECT_LT(compare_images(viewed(thing + at + ",0,120,0", set), viewed(turned + at, fresh)).nrmse, 0.015);
  // Between two turns, and scaled: the viewer as the renderer.
  EXPECT_LT(compare_images(viewed(thing + at + ",0,80,0,0.7", set), rendered(thing + at + ",0,80,0,0.7", set)).nrmse,
            0.02);
}

TEST_F(TurnedOccluders, GoRoundWithTheSkyAndAgainstIt) {
  const std::string thing = write("thing", 0);
  const std::string set = bake(thing, "set.exr", "--turns 3");
  const std::string one = bake(thing, "one.exr");
  // Turned as much as the sky is, one table says all: the first of the set.
  const std::string together = thing + "@0,0.2,0,0,120,0";
  const std::string turn = "--env-turn 120";
  const Film by_one = viewed(together, one, turn);
  EXPECT_LT(compare_images(viewed(together, set, turn), by_one).nrmse,
            1e-4);  // what is negligible is judged by all turns
  EXPECT_LT(compare_images(by_one, rendered(together, one, turn)).nrmse, 0.02);
  // Against the sky it is as the set baked under the turned sky has it.
  const std::string under = bake(thing, "under.exr", turn);
  const std::string still = thing + "@0,0.2,0";
  const Film truth = viewed(still, under, turn);
  EXPECT_LT(compare_images(viewed(still, set, turn), truth).nrmse, 0.015);
  EXPECT_LT(compare_images(rendered(still, set, turn), rendered(still, under, turn)).nrmse, 0.015);
  EXPECT_GT(compare_images(by_one, truth).nrmse, 0.03);
}

TEST_F(TurnedOccluders, AreRefusedWhereTheirTablesCannotTurn) {
  const std::string thing = write("thing", 0);
  const std::string one = bake(thing, "one.exr");
  const std::string view_of = "view --headless --size 32x24 --samples 1 " + scene("plaza.gltf") + sky() +
                              " --method fiv " + one + " -o " + path("x.png") + " --object " + thing;
  const std::string render_of = "render --method fiv --size 32x24 --samples 1 " + scene("plaza.gltf") + sky() +
                                " --occluder thing=" + one + " -o " + path("x.png") + " --object " + thing;
  const RunResult turned = run_ivory(view_of + "@0,0,0,0,30,0");
  EXPECT_EQ(turned.exit_code, 2) << turned.output;
  EXPECT_NE(turned.output.find("--turns"), std::string::npos) << turned.output;
  expect_one_line(render_of + "@0,0,0,0,30,0", 1, "--turns");
  const RunResult tilted = run_ivory(view_of + "@0,0,0,30,0,0");
  EXPECT_EQ(tilted.exit_code, 2) << tilted.output;
  EXPECT_NE(tilted.output.find("otherwise than about +Y"), std::string::npos) << tilted.output;
  expect_one_line(render_of + "@0,0,0,30,0,0", 1, "otherwise than about +Y");
  expect_one_line("bake fiv " + thing + sky() + " --turns 4 --certify -o " + path("y.exr"), 2, "--turns");
}

}  // namespace
}  // namespace ivory
