// ivory bake cubemap, and what renders and probes cube maps, as a script meets them.
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

class CubemapCommand : public CommandTest {
 protected:
};

// A tetrahedron with its corners 0.2 m and more from the origin, fronts outward, white.
std::string write_object(const std::string& name) {
  GltfBuilder gltf;
  const int indices = gltf.add_indices({0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2});
  const int positions =
      gltf.add(std::vector<V3f>{{0, 0.2F, 0}, {0.2F, -0.2F, 0.2F}, {0.2F, -0.2F, -0.2F}, {-0.2F, -0.2F, 0}});
  gltf.root["materials"].push_back(
      {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorFactor", {0.5, 0.5, 0.5, 1}}}},
       {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}});
  gltf.use_extension("KHR_materials_specular");
  const int mesh = gltf.add_mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", 0}});
  gltf.add_node({{"name", "object"}, {"mesh", mesh}});
  return gltf.write(name);
}

// L_e = 1, albedo 1/2: 2 nits from everywhere, E = 2 pi at every point, for every normal, by a map captured from a
// point off the centre, and a grey object of albedo 1/2 as bright as 1 nit.
TEST_F(CubemapCommand, FurnaceIsFlat) {
  const std::string furnace = scene("furnace_box.gltf");
  std::ofstream points(path("p.csv"));
  points << "x,y,z,nx,ny,nz\n0,0,0,1,0,0\n0.9,-0.9,0.9,1,1,-1\n-0.5,0.2,0.97,0,0,1\n0.1,0.9,-0.3,-1,-2,0.3\n3,0,0,-1,0,"
            "0\n";
  points.close();
  for (const int size : {2, 4, 8}) {
    const std::string map = path("f" + std::to_string(size) + ".exr");
    const Json bake = run("bake cubemap " + furnace + " --at 0.3,-0.2,0.4 --capture 64 --samples 16 -o " + map +
                          " --size " + std::to_string(size));
    EXPECT_NEAR(bake.at("mean_radiance_nits").at(0).get<double>(), 2, 0.01);  // 393,216 paths of a spread near 1
    EXPECT_NEAR(bake.at("nearest_m").get<double>(), 0.6, 0.001);
    const Json probe = run("probe " + map + " --points " + path("p.csv") + " -o " + path("e.csv") + " --force");
    EXPECT_NEAR(probe.at("mean_lux").at(0).get<double>() / (2 * 3.14159265), 1, 0.01);
    EXPECT_EQ(probe.at("outside").get<int>(), 1);
  }
  // A convolved map is the same light from everywhere; bytes as tests/grid/cubemap/reader.cpp counts them.
  const Json far =
      run("probe " + path("f4.exr") + " --lookup convolved --points " + path("p.csv") + " -o " + path("far.csv"));
  EXPECT_NEAR(far.at("mean_lux").at(0).get<double>() / (2 * 3.14159265), 1, 0.01);
  const Json bench = run("bench cubemap " + path("f4.exr")).at("maps").at(0);
  EXPECT_EQ(bench.at("convolved_bytes"), 6 * 16 * 16 * 12);
  EXPECT_EQ(bench.at("point_bytes"), 6 * 4 * 4 * 28);
  EXPECT_EQ(bench.at("polygon_paper_bytes"), 6 * 4 * 4 * 28);
  EXPECT_EQ(bench.at("polygon_bytes"), 6 * 4 * 4 * 28 + (12 * 4 * 4 + 5) * 28);
  for (const char* lookup : {"convolved", "point", "polygon_paper", "polygon"})
    EXPECT_GT(bench.at(std::string(lookup) + "_ns"), 0);
  const Json info = run("info " + path("f4.exr"));
  EXPECT_EQ(info.at("kind"), "cubemap");
  EXPECT_EQ(info.at("seed"), 1);
  const std::string object = write_object("cubemap_furnace_object");
  for (const std::string& method : {"--method cubemap --cubemap " + path("f4.exr"), std::string("--method path")}) {
    const Json render = run("render " + furnace + " --object " + object +
                            "@-0.1,0.1,0.2 --size 32x24 --samples 16 --force -o " + path("r.exr") + " " + method);
    // The object covers some of the picture; the rest is 2 nits.
    EXPECT_LT(render.at("mean_radiance_nits").at(0).get<double>(), 1.995) << method;
    EXPECT_GT(render.at("mean_radiance_nits").at(0).get<double>(), 1.5) << method;
  }
}

TEST_F(CubemapCommand, SameBytesOnAnyNumberOfThreads) {
  const std::string bake =
      "bake cubemap " + scene("two_rooms.gltf") + " --at 0.3,1.2,-7.5 --capture 16 --samples 4 -o ";
  run(bake + path("1.exr") + " --threads 1");
  run(bake + path("2.exr") + " --threads 2");
  EXPECT_FALSE(bytes_of(path("1.exr")).empty());
  EXPECT_EQ(bytes_of(path("1.exr")), bytes_of(path("2.exr")));
}

TEST_F(CubemapCommand, ReadsIndirectLightFromAGrid) {
  const std::string furnace = scene("furnace_box.gltf");
  run("bake grid " + furnace + " -o " + path("f.vdb") + " --resolution 4 --photons 1m");
  const Json bake = run("bake cubemap " + furnace + " --at 0,0,0 --capture 32 --samples 16 --grid " + path("f.vdb") +
                        " -o " + path("f.exr"));
  EXPECT_NEAR(bake.at("mean_radiance_nits").at(1).get<double>(), 2, 0.01);
  EXPECT_EQ(bake.at("indirect"), "grid");
}

// The same object as a node of the scene and beside it.
TEST_F(CubemapCommand, ObjectsAreFilesOrNodes) {
  const std::string knot = scene("detail_low.glb");
  run("bake cubemap " + knot + " --at 0,1.2,0 --without knot --capture 32 --samples 2 -o " + path("k.exr"));
  // Where the knot is left in, its surface is nearer than the pedestal's.
  const Json with = run("bake cubemap " + knot + " --at 0,1.2,0 --capture 32 --samples 2 -o " + path("with.exr"));
  const Json without =
      run("bake cubemap " + knot + " --at 0,1.2,0 --without knot --capture 32 --samples 2 -o " + path("without.exr"));
  EXPECT_LT(with.at("nearest_m").get<double>(), without.at("nearest_m").get<double>());
  EXPECT_NEAR(without.at("nearest_m").get<double>(), 0.7, 0.01);
  const std::string common = "render " + knot + " --size 24x18 --samples 4 --method cubemap --cubemap " + path("k.exr");
  const Json node = run(common + " --object knot -o " + path("a.exr"));
  EXPECT_EQ(node.at("objects"), "knot");
  const std::string object = write_object("cubemap_object");
  const Json placed = run(common + " --object " + object + "@0,2,0 --object knot -o " + path("b.exr"));
  EXPECT_NE(bytes_of(path("a.exr")), bytes_of(path("b.exr")));
  // Every method takes objects.
  run("render " + knot + " --size 24x18 --samples 4 --object " + object + "@0,2,0 -o " + path("c.exr"));
}

// A spherical light goes where its node goes.
TEST_F(CubemapCommand, LeavesBallsOfLightOutWithTheirNode) {
  GltfBuilder gltf;
  const int floor =
      gltf.add_mesh({{"attributes", {{"POSITION", gltf.add(std::vector<V3f>{{-9, -2, -9}, {0, -2, 9}, {9, -2, -9}})}}},
                     {"material", 0}});
  gltf.root["materials"].push_back({{"emissiveFactor", {1, 1, 1}}});
  gltf.add_node({{"name", "floor"}, {"mesh", floor}});
  gltf.add_node({{"name", "lamp"},
                 {"translation", {0, 1, 0}},
                 {"extras", {{"ivory_sphere_light", {{"radius", 0.25}, {"radiance", {9, 9, 9}}}}}}});
  const std::string room = gltf.write("cubemap_lamp");
  const std::string bake = "bake cubemap " + room + " --at 0,0,0 --capture 32 --samples 1 -o ";
  EXPECT_NEAR(run(bake + path("with.exr")).at("nearest_m").get<double>(), 0.75, 0.01);
  EXPECT_NEAR(run(bake + path("without.exr") + " --without lamp").at("nearest_m").get<double>(), 2, 0.01);
  EXPECT_EQ(run("render " + room + " --size 8x8 --samples 1 --method cubemap --object lamp --cubemap " +
                path("without.exr") + " -o " + path("r.exr"))
                .at("objects"),
            "lamp");
}

TEST_F(CubemapCommand, BadRequestsEndInOneLine) {
  const std::string furnace = scene("furnace_box.gltf");
  const std::string bake = "bake cubemap " + furnace + " --capture 16 --samples 1 -q --force -o " + path("x.exr");
  const std::string render = "render " + furnace + " --size 8x8 --samples 1 -o " + path("y.exr");
  const std::string object = write_object("cubemap_bad_object");
  run("bake cubemap " + furnace + " --at 0,0,0 --capture 16 --samples 1 -o " + path("good.exr"));
  run("render " + furnace + " --size 8x8 --samples 1 -o " + path("picture.exr"));
  std::ofstream(path("bad.exr")) << "nonsense";
  expect_one_line(bake + " --at 0,0,0 --size 3", 2, "does not divide");
  expect_one_line(bake + " --at 0,0,0 --size 32", 2, "does not divide");
  expect_one_line(bake + " --at 0,0,0 --size 0", 2, "--size");
  expect_one_line(bake + " --at 0,0,0 --size 128 --capture 128", 2, "--size");
  expect_one_line(bake + " --at 0,0", 2, "--at");
  expect_one_line(bake + " --at 0,nan,0", 2, "--at");
  expect_one_line(bake, 2, "--at");
  expect_one_line(bake + " --at 0,0,0 --grid " + path("missing.vdb"), 1, "missing.vdb");
  expect_one_line(bake + " --at 0,0,0 --without nobody", 2, "nobody");
  expect_one_line(bake + " --at 0,0,0 --without furnace", 1, "");
  // In the solid between two rooms: their walls' backs.
  expect_one_line("bake cubemap " + scene("two_rooms.gltf") + " --at 2.6,1,-7 --capture 16 -q -o " + path("x.exr"), 1,
                  "inside a wall");
  expect_one_line(bake + " --at 5,0,0", 1, "outside of the scene");  // sees the backs of the box
  expect_one_line(bake + " --at 1e6,0,0", 1, "nothing to be seen");
  EXPECT_FALSE(fs::exists(path("x.exr")));
  const Json beside = run("bake cubemap " + scene("cornell_box.gltf") +
                          " --at 0.2,0.25,-0.2 --capture 16 --samples 1 -o " + path("x.exr"));
  EXPECT_NE(beside.at("warnings").at(0).get<std::string>().find("outside of the scene"), std::string::npos);

  expect_one_line(render + " --method cubemap --object " + object, 2, "--cubemap");
  expect_one_line(render + " --method cubemap --cubemap " + path("good.exr"), 2, "--object");
  const std::string with = render + " --method cubemap --object " + object;
  expect_one_line(with + " --cubemap " + path("missing.exr"), 1, "missing.exr");
  expect_one_line(with + " --cubemap " + path("bad.exr"), 1, "bad.exr");
  expect_one_line(with + " --cubemap " + path("picture.exr"), 1, "bake cubemap");
  expect_one_line(with + " --indirect-only --cubemap " + path("good.exr"), 2, "--indirect-only");
  expect_one_line(render + " --method cubemap --object nobody --cubemap " + path("good.exr"), 2, "nobody");
  expect_one_line(render + " --object " + path("missing.glb"), 1, "missing.glb");
  expect_one_line(render + " --object " + object + "@1,2", 2, "--object");
  EXPECT_FALSE(fs::exists(path("y.exr")));
}

}  // namespace
}  // namespace ivory
