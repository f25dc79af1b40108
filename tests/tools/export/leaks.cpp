// Light behind thin walls in exported grids: what readers without a guard show of it, and what is said beforehand.
#include <array>
#include <cmath>

#include "tests/support/gltf_builder.h"
#include "tests/tools/export/grid_fixture.h"
#include "tests/tools/export/probe_files.h"

namespace ivory {
namespace {

using Json = nlohmann::json;

// A bright room of 4 x 2.5 x 4 m over a dim cellar of that depth, with a slab of that thickness between: boxes seen
// from inside, white, a lamp in each, the cellar's a thousandth of the other's.
std::string cellar_scene(float slab_m, float depth_m) {
  GltfBuilder builder;
  const auto add_room = [&](const V3f& low, const V3f& high) {
    std::vector<V3f> corners;
    for (int i = 0; i < 8; ++i)
      corners.emplace_back((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y, (i & 4) != 0 ? high.z : low.z);
    const std::vector<std::uint16_t> inwards{0, 2, 4, 2, 6, 4, 1, 5, 3, 3, 5, 7, 0, 4, 1, 1, 4, 5,
                                             2, 3, 6, 3, 7, 6, 0, 1, 2, 1, 3, 2, 4, 6, 5, 5, 6, 7};
    const int positions = builder.add(corners);
    builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", positions}}},
                                                 {"indices", builder.add_indices(inwards)},
                                                 {"material", 0}})}});
  };
  builder.root["materials"] = {
      {{"doubleSided", true},
       {"pbrMetallicRoughness", {{"baseColorFactor", {0.7, 0.7, 0.7, 1}}, {"metallicFactor", 0}}}}};
  add_room(V3f(-2, 0, -2), V3f(2, 2.5F, 2));
  add_room(V3f(-2, -depth_m - slab_m, -2), V3f(2, -slab_m, 2));
  builder.use_extension("KHR_lights_punctual");
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 100}},
                                                                 {{"type", "point"}, {"intensity", 0.1}}};
  for (int i = 0; i < 2; ++i) {
    builder.add_node({{"translation", {0.3, i == 0 ? 1.4 : -1.2 - double(slab_m), 0.2}},
                      {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  }
  return builder.write("cellar.gltf");
}

// Light of the upper room that shows on the cellar's ceiling, over the mean on the upper room's floor. Through a slab
// as thick as a cell next to nothing; through thinner ones, where they hold no probe, as much as is printed. They hold
// one or not as the vertices happen to stand: a cellar deeper by a quarter of a metre moves them.
TEST_F(ExportGrid, LeaksThroughThinSlabsOnly) {
  for (int i = 0; i < 10; ++i) {
    const float slab = std::array{0.01F, 0.05F, 0.2F, 0.5F, 0.7F}[std::size_t(i / 2)];
    const float depth = i % 2 == 0 ? 2.5F : 2.75F;
    const IrradianceGrid grid = bake(cellar_scene(slab, depth), "--voxel-size 0.5");
    const Json three_js = export_to("three.js", "three.ktx2");
    export_to("bevy", "bevy.ktx2");
    const Texture3d three(path("three.ktx2"));
    const Placement three_at(path("three.json"));
    const Texture3d bevy(path("bevy.ktx2"));
    const Placement bevy_at(path("bevy.json"));
    const auto mean = [&](float y, const V3d& n, const auto& reader) {
      double sum = 0;
      int count = 0;
      for (double x = -1.7; x < 1.8; x += 0.34)
        for (double z = -1.7; z < 1.8; z += 0.34) {
          sum += reader(V3d(x, y, z), n).x;
          ++count;
        }
      return sum / count;
    };
    const V3d up(0, 1, 0);
    const V3d down(0, -1, 0);
    const auto of_three = [&](const V3d& p, const V3d& n) { return read_three_js(three, three_at, p, n); };
    const auto of_bevy = [&](const V3d& p, const V3d& n) {
      return read_bevy(bevy, bevy_at, bevy_at.json["intensity"], p, n) * 3.14159265358979;
    };
    const auto of_grid = [&](const V3d& p, const V3d& n) {
      return V3d(lookup_irradiance(grid, V3f(p), V3f(n), V3f(n), LookupParams()));
    };
    const double floor = mean(0, up, of_grid);
    const double ceiling = mean(-slab, down, of_grid);
    const double leak_three = (mean(-slab, down, of_three) - ceiling) / floor;
    const double leak_bevy = (mean(-slab, down, of_bevy) - ceiling) / floor;
    std::printf(
        "slab %.2f m over %.2f m: ceiling %.4f of the floor's E by planes; leak %.2f %% three.js, %.2f %% Bevy; %d "
        "pairs of "
        "neighbours do not see each other\n",
        double(slab), double(depth), ceiling / floor, 100 * leak_three, 100 * leak_bevy,
        three_js["thin_walls"].get<int>());
    EXPECT_LT(ceiling / floor, 0.005);
    if (slab >= 0.5F) {
      EXPECT_LT(std::abs(leak_three), 0.01) << slab;
      EXPECT_LT(std::abs(leak_bevy), 0.01) << slab;
      // Nor is the floor dimmed.
      EXPECT_NEAR(mean(0, up, of_bevy) / floor, 1, 0.03);
      EXPECT_NEAR(mean(0, up, of_three) / floor, 1, 0.03);
    }
    // What is thinner than a cell and may leak is said.
    if (std::max(leak_three, leak_bevy) > 0.01) {
      EXPECT_GT(three_js["thin_walls"], 0) << slab;
    }
  }
}

// --report says where readers will show what they should not, by the planes alone and by rays in the scene.
TEST_F(ExportGrid, ReportsLeaksBeforeTheyShip) {
  const std::string thin = cellar_scene(0.05F, 2.75F);
  bake(thin, "--voxel-size 0.5");
  for (const std::string& with_scene : {std::string(), " --scene " + thin}) {
    const Json report = export_to("bevy", "bevy.ktx2", "--report " + path("report.html") + with_scene)["report"];
    const Texture3d bevy(path("bevy.ktx2"));
    const Placement at(path("bevy.json"));
    EXPECT_GT(report["too_bright"], 0.05) << with_scene;  // the cellar's ceiling is a tenth of all surfaces
    ASSERT_FALSE(report["worst"].empty());
    // The worst places are the ceiling's, and what is said to be shown there is what Bevy's formula shows.
    for (const Json& place : report["worst"]) {
      const V3d p = Placement::vector(place["p_m"]);
      const V3d n = Placement::vector(place["n"]);
      if (place["off"].get<double>() < 0.15) continue;
      EXPECT_LT(p.y, -0.04) << place;
      EXPECT_GT(p.y, -0.6) << place;
      const double shown = read_bevy(bevy, at, at.json["intensity"], p, n).x * 3.14159265358979;
      EXPECT_NEAR(place["shown_lux"].get<double>() / shown, 1, 0.01);  // half floats
    }
    const Json& wall = report["thin_walls"].at(0);
    EXPECT_EQ(wall["across"], "y");
    EXPECT_NEAR(wall["center_m"][1].get<double>(), -0.025, 0.25);
    EXPECT_NEAR(wall["area_m2"].get<double>(), 16, 4);
    EXPECT_GT(wall["brightest"], 0.1);
    const std::string page = bytes_of(path("report.html"));
    EXPECT_NE(page.find("Walls thinner than a cell"), std::string::npos);
    EXPECT_NE(page.find("<circle"), std::string::npos);
  }
  const RunResult said =
      run_ivory("export " + path("g.vdb") + " --to bevy -o " + path("x.ktx2") + " --report " + path("x.html"));
  EXPECT_NE(said.output.find("wall thinner than a cell at"), std::string::npos) << said.output;
  expect_one_line("export " + path("g.vdb") + " --to usd -o " + path("x.usda") + " --report " + path("y.html"), 2,
                  "--report");
  expect_one_line("export " + path("g.vdb") + " --to bevy -o " + path("y.ktx2") + " --report " + path("y.txt"), 2,
                  ".html");

  bake(cellar_scene(0.7F, 2.75F), "--voxel-size 0.5");
  const Json thick = export_to("bevy", "bevy.ktx2", "--report " + path("thick.html"))["report"];
  EXPECT_TRUE(thick["thin_walls"].empty());
  EXPECT_LT(thick["too_bright"], 0.02);
}

}  // namespace
}  // namespace ivory
