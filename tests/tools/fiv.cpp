// ivory bake fiv, and what renders and probes its tables, as a script meets them.
#include <algorithm>
#include <cmath>
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
using Json = nlohmann::json;

class FivCommand : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    write_mesh("thing.glb", "thing", thing());
    write_environment("sky.hdr", 3);
    write_environment("other.hdr", 1);
  }

  // A wedge without symmetry, fronts outward.
  static std::vector<V3f> thing() {
    return {{-0.5F, 0, -0.3F}, {0.6F, 0.1F, -0.2F}, {0, 0.05F, 0.6F}, {0.1F, 0.9F, 0}};
  }

  void write_mesh(const std::string& name, const std::string& node, const std::vector<V3f>& corners,
                  const std::string& extras = {}) const {
    GltfBuilder gltf;
    const bool quad = corners.size() == 4 && corners[0].y == corners[3].y;
    const int indices =
        quad ? gltf.add_indices({0, 1, 2, 0, 2, 3}) : gltf.add_indices({0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0});
    const int positions = gltf.add(corners);
    gltf.root["materials"].push_back(
        {{"pbrMetallicRoughness", {{"baseColorFactor", {0.6, 0.6, 0.6, 1}}, {"metallicFactor", 0}}},
         {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}},
         {"doubleSided", true}});
    gltf.use_extension("KHR_materials_specular");
    const int mesh = gltf.add_mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", 0}});
    Json one = {{"mesh", mesh}, {"name", node}};
    if (!extras.empty()) one["extras"] = {{"ivory_occluder", extras}};
    gltf.add_node(one);
    Json root = gltf.root;
    root["buffers"].push_back({{"byteLength", gltf.bytes.size()}});
    GltfBuilder::write_file(path(name),
                            GltfBuilder::glb(root.dump(), std::string(gltf.bytes.begin(), gltf.bytes.end())));
  }

  // Radiance .hdr, 16 x 8: dim, with a bright patch above.
  void write_environment(const std::string& name, int brightness) const {
    std::ofstream file(path(name), std::ios::binary);
    file << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n";
    for (int row = 0; row < 8; ++row) {
      for (int column = 0; column < 16; ++column) {
        const bool patch = row == 1 && column >= 3 && column < 6;
        file << char(128) << char(130) << char(140) << char(patch ? 128 + brightness : 126);
      }
    }
  }

  // A coarse table: most of what is looked at here does not depend on how fine it is.
  std::string bake(const std::string& mesh, const std::string& out, const std::string& more = {},
                   const std::string& fineness = "--samples 16,9,8 --silhouette 32 --parts 256") const {
    return "bake fiv " + path(mesh) + " --env " + path("sky.hdr") + " -o " + path(out) + " " + fineness + " " + more;
  }
};

TEST_F(FivCommand, StoresNineChannelsAndSaysHowItWasMade) {
  const Json baked = run(bake("thing.glb", "a.exr"));
  EXPECT_EQ(baked["table_bytes"], 16 * 9 * 8 * 9 * 4);
  const Json info = run("info " + path("a.exr"));
  EXPECT_EQ(info["kind"], "fiv");
  EXPECT_EQ(info["channels"], Json({"Fx.R", "Fx.G", "Fx.B", "Fy.R", "Fy.G", "Fy.B", "Fz.R", "Fz.G", "Fz.B"}));
  EXPECT_EQ(info["mesh"], "thing.glb");
  EXPECT_EQ(info["environment"], "sky.hdr");
  EXPECT_EQ(info["units"], "lux");
  for (const char* key : {"mesh_hash", "environment_hash", "version", "environment_size", "radii", "sphere_m"})
    EXPECT_TRUE(info.contains(key)) << key;
  run(bake("thing.glb", "half.exr", "--precision float16"));
  EXPECT_LT(fs::file_size(path("half.exr")), fs::file_size(path("a.exr")));
  EXPECT_EQ(run(bake("thing.glb", "six.exr", "--hemispheres 6"))["table_bytes"], 16 * 9 * 8 * 36 * 4);
}

TEST_F(FivCommand, GivesTheSameBytesAtAnyThreadCount) {
  run(bake("thing.glb", "one.exr", "--threads 1"));
  run(bake("thing.glb", "two.exr", "--threads 2"));
  EXPECT_EQ(bytes_of(path("one.exr")), bytes_of(path("two.exr")));
}

// The picture by tables beside the path tracer's direct light. The table's own error at this size is about 1 % of the
// light and the path tracer's noise at 256 samples another.
TEST_F(FivCommand, RendersAsThePathTracerDoes) {
  write_mesh("floor.glb", "floor", {{-3, -0.02F, -3}, {-3, -0.02F, 3}, {3, -0.02F, 3}, {3, -0.02F, -3}});
  run(bake("thing.glb", "a.exr", "--hemispheres 6", "--samples 48,25,16"));
  const std::string common = "render " + path("floor.glb") + " --env " + path("sky.hdr") + " --object " +
                             path("thing.glb") + "@0.8,0,0.4 --object " + path("thing.glb") +
                             "@-0.9,0.2,0 --size 96x72 ";
  run(common + "--method path --max-bounces 1 --samples 256 -o " + path("truth.exr"));
  for (const std::string overlap : {"covers", "discs", "product", "none"}) {
    run(common + "--method fiv --occluder thing=" + path("a.exr") + " --samples 16 --force --overlap " + overlap +
        " -o " + path("fiv.exr"));
    const Json same = run("compare " + path("fiv.exr") + " " + path("truth.exr"));
    EXPECT_LT(same["nrmse"], 0.02) << overlap;
  }
  run(common + "--method fiv --samples 16 -o " + path("bare.exr"));  // no occluders: nothing is shadowed
  EXPECT_GT(run("compare " + path("bare.exr") + " " + path("truth.exr"))["nrmse"], 0.03);
}

TEST_F(FivCommand, FindsTablesInExtras) {
  run(bake("thing.glb", "a.exr"));
  write_mesh("marked.glb", "thing", thing(), "a.exr");
  const std::string common = "render " + path("thing.glb") + " --env " + path("sky.hdr") + " --size 48x36 --samples 4 ";
  run(common + "--method fiv --occluder thing=" + path("a.exr") + " -o " + path("given.exr"));
  std::string marked = common;
  marked.replace(marked.find("thing.glb"), 9, "marked.glb");
  run(marked + "--method fiv -o " + path("found.exr"));
  EXPECT_EQ(run("compare " + path("found.exr") + " " + path("given.exr"))["max"], 0);
  // Other methods leave the mark alone.
  run(marked + "--method path --max-bounces 1 -o " + path("path.exr"));
}

TEST_F(FivCommand, ReadsUnshadowedLightFromBakedAssets) {
  run(bake("thing.glb", "a.exr"));
  run("bake difmap " + path("sky.hdr") + " -o " + path("difmap.exr"));
  run("bake sh9 " + path("sky.hdr") + " --order 2 -o " + path("sh9.json"));
  run("bake difmap " + path("other.hdr") + " -o " + path("other.exr"));
  const std::string common = "render " + path("thing.glb") + " --env " + path("sky.hdr") +
                             " --size 48x36 --samples 4 --method fiv --occluder thing=" + path("a.exr");
  run(common + " -o " + path("own.exr"));
  run(common + " --ambient " + path("difmap.exr") + " -o " + path("map.exr"));
  run(common + " --ambient " + path("sh9.json") + " -o " + path("sh.exr"));
  EXPECT_LT(run("compare " + path("map.exr") + " " + path("own.exr"))["nrmse"], 1e-5);
  EXPECT_LT(run("compare " + path("sh.exr") + " " + path("own.exr"))["nrmse"], 0.1);
  expect_one_line(common + " --ambient " + path("other.exr") + " -o " + path("x.exr"), 1, "another environment");
}

TEST_F(FivCommand, ProbesHiddenLight) {
  run(bake("thing.glb", "a.exr", "--hemispheres 6"));
  std::ofstream(path("p.csv")) << "x,y,z,nx,ny,nz\n0,-1,0,0,1,0\n0,-1,0,0,-1,0\n0,50,0,0,1,0\n0,0,0,1,0,0\n";
  const Json result = run("probe " + path("a.exr") + " --points " + path("p.csv") + " -o " + path("e.csv"));
  EXPECT_EQ(result["source"], "fiv");
  std::ifstream file(path("e.csv"));
  std::string header;
  std::string under;
  std::string below;
  std::getline(file, header);
  std::getline(file, under);
  std::getline(file, below);
  const auto red = [](const std::string& line) {
    std::istringstream cells(line);
    std::string cell;
    for (int i = 0; i < 7; ++i) std::getline(cells, cell, ',');
    return std::stod(cell);
  };
  EXPECT_GT(red(under), 0.01);
  EXPECT_EQ(red(below), 0);
}

TEST_F(FivCommand, TablesOfOtherLightOrOtherMeshesAreRefused) {
  run(bake("thing.glb", "a.exr"));
  const std::string render = "render " + path("thing.glb") + " --method fiv --size 8x8 --samples 1 -o " + path("x.exr");
  expect_one_line(render + " --env " + path("other.hdr") + " --occluder thing=" + path("a.exr"), 1,
                  "another environment (sky.hdr)");
  std::vector<V3f> turned;
  for (const V3f& p : thing()) turned.emplace_back(p.x, -p.y, -p.z);
  write_mesh("turned.glb", "thing", turned);
  std::string other = render;
  other.replace(other.find("thing.glb"), 9, "turned.glb");
  expect_one_line(other + " --env " + path("sky.hdr") + " --occluder thing=" + path("a.exr"), 1, "does not belong");
  expect_one_line(render + " --env " + path("sky.hdr") + " --occluder none=" + path("a.exr"), 2, "no node 'none'");
  expect_one_line(render + " --env " + path("sky.hdr") + " --occluder " + path("a.exr"), 2, "NODE=TABLE.exr");
  expect_one_line(render + " --occluder thing=" + path("a.exr"), 2, "--env");
  expect_one_line(render + " --env " + path("sky.hdr") + " --occluder thing=" + path("thing.glb"), 1, "OpenEXR");
  EXPECT_FALSE(fs::exists(path("x.exr")));
}

TEST_F(FivCommand, BadInputEndsInOneLine) {
  const std::string end = " -o " + path("x.exr");
  const std::string sky = " --env " + path("sky.hdr");
  expect_one_line("bake fiv " + path("missing.glb") + sky + end, 1, "missing.glb");
  expect_one_line("bake fiv " + path("thing.glb") + " --env " + path("missing.hdr") + end, 1, "missing.hdr");
  expect_one_line("bake fiv " + path("thing.glb") + end, 2, "--env");
  expect_one_line("bake fiv " + path("thing.glb") + sky + " -o " + path("x.png"), 2, ".exr");
  expect_one_line("bake fiv " + path("thing.glb") + sky + end + " --samples 2,2,2", 2, "--samples");
  expect_one_line("bake fiv " + path("thing.glb") + sky + end + " --samples 60000,60000,60000", 1, "memory");
  expect_one_line("bake fiv " + path("thing.glb") + sky + end + " --hemispheres 3", 2, "--hemispheres");
  // All corners in one place: nothing is left to hide light.
  write_mesh("flat.glb", "flat", {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 1, 0}});
  const RunResult flat = run_ivory("bake fiv " + path("flat.glb") + sky + end + " --quiet");
  EXPECT_EQ(flat.exit_code, 1);
  EXPECT_NE(flat.output.find("flat.glb"), std::string::npos) << flat.output;
  // A triangle alone has no volume, and hides light like any other mesh.
  write_mesh("sheet.glb", "sheet", {{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}});
  run(bake("sheet.glb", "sheet.exr"));
  EXPECT_FALSE(fs::exists(path("x.exr")));
}

}  // namespace
}  // namespace ivory
