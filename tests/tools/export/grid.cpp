// ivory export of grids: what each reader shows, by its own look-up on the files alone, against ivory's own E.
#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>

#include <nanovdb/util/IO.h>
#include <nanovdb/util/SampleFromVoxels.h>

#include "grid/env/sh9.h"
#include "tests/tools/export/grid_fixture.h"
#include "tests/tools/export/node_reader.h"
#include "tests/tools/export/probe_files.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// Of a grid of nine coefficients three.js' volume holds everything: where it looks, half a cell along the normal, it
// shows what ivory has there, to half floats and the clamping of each basis at 0.
TEST_F(ExportGrid, ThreeJsShowsTheGrid) {
  for (const char* basis : {"sh9", "vectors"}) {
    const IrradianceGrid grid = bake(scene("room_boxes.gltf"), std::string("--resolution 16 --basis ") + basis);
    const Json result = export_to("three.js", "room.ktx2");
    const Texture3d texture(path("room.ktx2"));
    const Placement at(path("room.json"));
    EXPECT_EQ(texture.file().vk_format, 97U);
    EXPECT_EQ(int(texture.file().depth), 7 * (at.size.z + 2));
    const std::vector<Point> points = points_of(grid, false, 3);
    const auto reader = [&](const V3d& p, const V3d& n) { return read_three_js(texture, at, p, n); };
    const double there = relative_rms(
        points, reader, [&](const Point& i) { return truth(grid, i.p + i.n * grid.frame.spacing_m * 0.5F, i.n); });
    // Six vectors are clamped into their brackets, which nine coefficients cannot follow: the format's own loss.
    EXPECT_LT(there, std::string(basis) == "sh9" ? 1e-3 : 1e-2) << basis;
    // At the point itself the half cell shows; what is stated is measured at other points of the same kind: the RMS of
    // 200 varies by a tenth.
    const double here = relative_rms(points, reader, [&](const Point& i) { return truth(grid, i.p, i.n); });
    EXPECT_NEAR(result["loss"]["in_the_open"].get<double>() / here, 1, 0.35) << basis;
    EXPECT_LT(result["loss"]["on_surfaces"], 0.02) << basis;
    EXPECT_EQ(result["loss"]["points_on_surfaces"], 200);
  }
}

// Six sides hold what the normals along the axes see, to half floats or nine bits; a turned grid too, as Bevy turns its
// volume but not the normals.
TEST_F(ExportGrid, BevyShowsTheGrid) {
  for (const bool rotated : {false, true}) {
    const IrradianceGrid grid = bake(scene(rotated ? "room_boxes_rotated.gltf" : "room_boxes.gltf"),
                                     rotated ? "--resolution 16 --rotate-y 30" : "--resolution 16");
    for (const char* texels : {"half", "rgb9e5"}) {
      const Json result = export_to("bevy", "room.ktx2", std::string("--texels ") + texels);
      const Texture3d texture(path("room.ktx2"));
      const Placement at(path("room.json"));
      EXPECT_EQ(texture.file().vk_format, std::string(texels) == "half" ? 97U : 123U);
      EXPECT_EQ(int(texture.file().height), 2 * at.size.y);
      EXPECT_EQ(int(texture.file().depth), 3 * at.size.z);
      const auto reader = [&](const V3d& p, const V3d& n) {
        return read_bevy(texture, at, at.json["intensity"], p, n) * 3.14159265358979;
      };
      const auto e_of = [&](const Point& i) { return truth(grid, i.p, i.n); };
      EXPECT_LT(relative_rms(points_of(grid, true, 4), reader, e_of), 0.01) << texels << rotated;
      const double loss = relative_rms(points_of(grid, false, 5), reader, e_of);
      EXPECT_NEAR(result["loss"]["in_the_open"].get<double>() / loss, 1, 0.35) << texels << rotated;
      // The Transform puts the unit cube there: scaled, turned by the quaternion, moved.
      const Json& transform = at.json["transform"];
      const V3d q = Placement::vector(transform["rotation"]);
      const double w = transform["rotation"][3];
      for (unsigned axis = 0; axis < 3; ++axis) {
        V3d unit(0, 0, 0);
        unit[axis] = 1;
        const V3d turned = unit + q.cross(unit) * (2 * w) + q.cross(q.cross(unit)) * 2;
        EXPECT_LT((turned - at.axes[axis]).length(), 1e-5);
      }
      EXPECT_EQ(Placement::vector(transform["scale"]), at.extent);
      EXPECT_EQ(Placement::vector(transform["translation"]), at.center);
    }
  }
}

TEST_F(ExportGrid, PlainVolumesAreAsTheirFilesSay) {
  const IrradianceGrid grid = bake(scene("room_boxes.gltf"), "--resolution 16 --basis sh9");
  const std::vector<Point> points = points_of(grid, true, 6);
  const auto e_of = [&](const Point& i) { return truth(grid, i.p, i.n); };
  export_to("sides", "sides.ktx2");
  {
    const Texture3d texture(path("sides.ktx2"));
    const Placement at(path("sides.json"));
    EXPECT_EQ(at.json["sides"], (Json{"+x", "-x", "+y", "-y", "+z", "-z"}));
    const auto reader = [&](const V3d& p, const V3d& n) {
      const unsigned axis = n.x != 0 ? 0U : (n.y != 0 ? 1U : 2U);
      return read_block(texture, at, int(2 * axis + (n[axis] < 0 ? 1U : 0U)), 6, p);
    };
    EXPECT_LT(relative_rms(points, reader, e_of), 0.01);
    // Each side's last slice has its copy behind it.
    const int nz = at.size.z;
    for (int block = 0; block < 6; ++block) {
      EXPECT_EQ(texture.texel(3, 4, block * (nz + 2)), texture.texel(3, 4, block * (nz + 2) + 1));
      EXPECT_EQ(texture.texel(3, 4, block * (nz + 2) + nz + 1), texture.texel(3, 4, block * (nz + 2) + nz));
    }
  }
  export_to("sh9", "sh9.ktx2");
  const Texture3d texture(path("sh9.ktx2"));
  const Placement at(path("sh9.json"));
  const auto reader = [&](const V3d& p, const V3d& n) {
    Sh9 sh;
    for (std::size_t i = 0; i < 9; ++i) sh.coefficients[i] = read_block(texture, at, int(i), 9, p);
    return irradiance_polynomial(sh, n);
  };
  EXPECT_LT(relative_rms(points_of(grid, false, 7), reader, e_of), 0.01);
}

// By NanoVDB's own reader and sampler.
TEST_F(ExportGrid, NanoVdbShowsTheGrid) {
  for (const bool rotated : {false, true}) {
    const IrradianceGrid grid = bake(scene(rotated ? "room_boxes_rotated.gltf" : "room_boxes.gltf"),
                                     rotated ? "--resolution 12 --rotate-y 30" : "--resolution 12");
    export_to("nanovdb", "room.nvdb");
    const auto handles = nanovdb::io::readGrids(path("room.nvdb"));
    ASSERT_EQ(handles.size(), 6U);
    EXPECT_STREQ(handles[3].grid<nanovdb::Vec3f>()->gridName(), "E_my");
    const auto reader = [&](const V3d& p, const V3d& n) {
      const unsigned axis = n.x != 0 ? 0U : (n.y != 0 ? 1U : 2U);
      const auto* volume = handles[2 * axis + (n[axis] < 0 ? 1U : 0U)].grid<nanovdb::Vec3f>();
      EXPECT_NE(volume, nullptr);
      const auto sampler = nanovdb::createSampler<1>(volume->tree());
      const nanovdb::Vec3f e = sampler(volume->worldToIndexF(nanovdb::Vec3f(float(p.x), float(p.y), float(p.z))));
      return V3d(e[0], e[1], e[2]);
    };
    // The basis' clamping between vertices.
    EXPECT_LT(relative_rms(points_of(grid, true, 11), reader, [&](const Point& i) { return truth(grid, i.p, i.n); }),
              0.01)
        << rotated;
  }
}

TEST_F(ExportGrid, UsdNamesTheFilesGrids) {
  bake(scene("room_boxes.gltf"), "--resolution 4");
  fs::create_directories(path("stage"));
  const Json result = export_to("usd", "stage/room.usda");
  EXPECT_EQ(result["fields"].size(), 22U);
  const std::string stage = bytes_of(path("stage/room.usda"));
  EXPECT_TRUE(stage.starts_with("#usda 1.0\n"));
  EXPECT_NE(stage.find("upAxis = \"Y\""), std::string::npos);
  for (const Json& field : result["fields"]) {
    const auto name = field.get<std::string>();
    EXPECT_NE(stage.find("rel field:" + name + " = </ivory/" + name + ">"), std::string::npos);
    const bool scalar = name == "visible_fraction";
    EXPECT_NE(stage.find("def OpenVDBAsset \"" + name +
                         "\"\n    {\n        asset filePath = @../g.vdb@\n        token "
                         "fieldName = \"" +
                         name + "\"\n        token fieldDataType = \"" + (scalar ? "float" : "float3") + "\""),
              std::string::npos)
        << name;
  }
  expect_one_line("export " + path("g.vdb") + " --to usd --voxel-size 1 -o " + path("x.usda"), 2, "--voxel-size");
}

// Volumes of several levels, and turned ones where the reader cannot turn them, are resampled, and it is said.
TEST_F(ExportGrid, ResamplesWhatReadersCannotTake) {
  const IrradianceGrid levels = bake(scene("two_rooms.gltf"), "--voxel-size 0.5 --levels 2");
  const Json of_levels = export_to("sh9", "levels.ktx2");
  EXPECT_TRUE(of_levels["resampled"]);
  EXPECT_NEAR(of_levels["spacing_m"][0].get<double>(), 0.5, 0.01);  // of the finest level
  EXPECT_LT(of_levels["loss"]["in_the_open"], 0.03);
  const IrradianceGrid turned = bake(scene("room_boxes_rotated.gltf"), "--resolution 16 --rotate-y 30");
  const Json of_turned = export_to("three.js", "turned.ktx2");
  EXPECT_TRUE(of_turned["resampled"]);
  EXPECT_EQ(of_turned["axes"], Json::parse("[[1,0,0],[0,1,0],[0,0,1]]"));
  EXPECT_LT(of_turned["loss"]["in_the_open"], 0.05);
  // By another way: the file's look-up against the grid's at points in the open.
  const Texture3d texture(path("turned.ktx2"));
  const Placement at(path("turned.json"));
  const double rms = relative_rms(
      points_of(turned, false, 8), [&](const V3d& p, const V3d& n) { return read_three_js(texture, at, p, n); },
      [&](const Point& i) { return truth(turned, i.p + i.n * V3f(V3d(at.extent / V3d(at.size))) * 0.5F, i.n); });
  EXPECT_LT(rms, 0.03);  // between other vertices than the grid's, which the light is not linear between
  const RunResult result = run_ivory("export " + path("g.vdb") + " --to sides -o " + path("x.ktx2"));
  EXPECT_NE(result.output.find("resampled along the world's axes"), std::string::npos) << result.output;
  expect_one_line("export " + path("g.vdb") + " --to sides --voxel-size 0.001 -o " + path("y.ktx2"), 2, "--voxel-size");
  EXPECT_FALSE(fs::exists(path("y.ktx2")));
}

// The loader that is written, run by three.js itself: probes stand where the grid's vertices do, and hold its light.
TEST_F(ExportGrid, ThreeJsLoadsIt) {
  SKIP_WITHOUT_NODE_PACKAGES();
  const IrradianceGrid grid = bake(scene("room_boxes.gltf"), "--resolution 8 --basis sh9");
  export_to("three.js", "room.ktx2");
  fs::create_directory_symlink(std::getenv("IVORY_NODE_MODULES"), path("node_modules"));
  fs::rename(path("room.js"), path("room.mjs"));  // node tells modules by their names
  const Json read = run_reader("probe_grid.mjs", path("room.mjs") + " " + path("room.ktx2"));
  ASSERT_FALSE(read.is_discarded());
  ASSERT_EQ(read["probes"].size(), grid.frame.vertex_count());
  EXPECT_EQ(read["filter"], 1006);  // LinearFilter
  double worst = 0;
  double most = 0;
  for (std::size_t v = 0; v < grid.frame.vertex_count(); ++v) {
    const Json& probe = read["probes"][v];
    const V3f p = grid.frame.to_world(V3f(grid.frame.vertex_coordinates(v)));
    EXPECT_LT((Placement::vector(probe["position"]) - V3d(p)).length(), 1e-4);
    if (grid.visible_fraction[v] < 0.25F) continue;
    Footprint one;
    one.count = 1;
    one.vertex[0] = std::uint32_t(v);
    one.weight[0] = 1;
    const V3f n(0.48F, 0.64F, -0.6F);
    const Rgb e = irradiance(grid, one, n, Reconstruction::optimal);
    if (is_black(e)) continue;
    worst = std::max(worst, std::abs(std::max(0.0, probe["e"][0].get<double>()) - e.x));
    most = std::max(most, double(e.x));
  }
  EXPECT_LT(worst, 2e-3 * most);  // half floats
}

TEST_F(ExportGrid, SaysWhatDoesNotGo) {
  bake(scene("room_boxes.gltf"), "--resolution 4");
  const std::string grid = "export " + path("g.vdb");
  expect_one_line(grid + " --to playcanvas -o " + path("x.json"), 2, "takes no grid");
  expect_one_line(grid + " --to three.js -o " + path("x.json"), 2, ".ktx2");
  expect_one_line(grid + " --to three.js --texels half -o " + path("x.ktx2"), 2, "--texels");
  expect_one_line(grid + " --to bevy --voxel-size 0 -o " + path("x.ktx2"), 2, "--voxel-size");
  export_to("three.js", "x.ktx2");
  fs::remove(path("x.ktx2"));
  expect_one_line(grid + " --to three.js -o " + path("x.ktx2"), 1, "x.js");  // what would lie beside it is there
  EXPECT_FALSE(fs::exists(path("x.ktx2")));
  // The same bytes at any number of threads.
  export_to("sh9", "one.ktx2", "--threads 1");
  export_to("sh9", "two.ktx2", "--threads 2");
  EXPECT_EQ(bytes_of(path("one.ktx2")), bytes_of(path("two.ktx2")));
}

}  // namespace
}  // namespace ivory
