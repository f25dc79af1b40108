// Scenes far from the world's origin and in other units, by every command: the light of a moved scene is that of the
// scene, to the last digit where the distance is a round number.
#include <sstream>

#include "tests/tools/script.h"

namespace ivory::script {

namespace {

const std::string scenes_folder = std::string(source_folder) + "/scenes/";

// The scene below a root node.
void write_below_root(const fs::path& path, const std::string& scene_name, const Json& root) {
  Json gltf = Json::parse(read_file(scenes_folder + scene_name));
  Json node = root;
  node["children"] = gltf["scenes"][0]["nodes"];
  gltf["scenes"][0]["nodes"] = Json::array({gltf["nodes"].size()});
  gltf["nodes"].push_back(node);
  write_file(path, gltf.dump());
}

struct Shift {
  double x, y, z;
  std::string place(double px, double py, double pz) const {
    std::ostringstream text;
    text.precision(17);
    text << px + x << "," << py + y << "," << pz + z;
    return text.str();
  }
};

// Columns r,g,b,r_se,g_se,b_se of all rows.
std::string light_of(const fs::path& csv) {
  std::istringstream in(read_file(csv));
  std::string light;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::size_t at = 0;
    for (int comma = 0; comma < 6; ++comma) at = line.find(',', at) + 1;
    light += line.substr(at) + "\n";
  }
  return light;
}

void write_points(const fs::path& path, const Shift& s) {
  std::string text = "x,y,z,nx,ny,nz\n";
  text += s.place(0.5, 0.25, -0.75) + ",0,1,0\n" + s.place(-1.25, 1.5, 0.5) + ",1,0,0\n";
  text += s.place(-0.5, 2.25, 1) + ",0,-1,0\n" + s.place(1.75, 0.5, 1) + ",0,0.6,-0.8\n";
  write_file(path, text);
}

void expect_ok(const fs::path& folder, const std::string& arguments) {
  const Outcome outcome = ivory(folder, arguments + " -q");
  EXPECT_EQ(outcome.exit_code, 0) << arguments << "\n" << outcome.err;
}

const Shift here{0, 0, 0};
const Shift national{450000, 100, -5000000};

TEST(Far, GridPathAndCubeMapReadTheSame) {
  const auto folder = scratch_folder("far_twins");
  std::array<std::string, 4> first;
  for (const Shift& s : {here, national}) {
    write_below_root(folder / "room.gltf", "room_boxes.gltf", {{"translation", {s.x, s.y, s.z}}});
    write_points(folder / "p.csv", s);
    const std::string bounds = s.place(-2, 0.25, -1.5) + ":" + s.place(2, 2.5, 1.5);
    expect_ok(folder, "bake grid room.gltf -o g.vdb --resolution 6 --photons 20k --force --bounds " + bounds +
                          " --dynamic " + bounds);
    expect_ok(folder, "probe g.vdb --points p.csv -o alone.csv --force");
    expect_ok(folder, "probe g.vdb --points p.csv -o rays.csv --scene room.gltf --force");
    expect_ok(folder, "probe room.gltf --points p.csv -o path.csv --samples 16 --force");
    expect_ok(folder, "bake cubemap room.gltf -o c.exr --capture 16 --samples 2 --force --at " + s.place(0.5, 1.5, 0));
    expect_ok(folder, "probe c.exr --points p.csv -o cube.csv --force");
    std::array<std::string, 4> light;
    const std::array<const char*, 4> files{"alone.csv", "rays.csv", "path.csv", "cube.csv"};
    for (std::size_t i = 0; i < files.size(); ++i) light[i] = light_of(folder / files[i]);
    if (first[0].empty()) first = light;
    for (std::size_t i = 0; i < files.size(); ++i) EXPECT_EQ(light[i], first[i]) << files[i] << " at x = " << s.x;
    EXPECT_NE(light[0].find_first_of("123456789"), std::string::npos);  // not dark
  }
  // What files say is the user's.
  const Json grid = Json::parse(ivory(folder, "info g.vdb --json").out);
  EXPECT_NEAR(grid["origin_m"][2].get<double>(), -5000000 - 1.25, 1e-6);
  EXPECT_EQ(grid["bounds"], "449998,100.25,-5000001.5:450002,102.5,-4999998.5");
  const Json room = Json::parse(ivory(folder, "info room.gltf --json").out);
  EXPECT_NEAR(room["bounds_min_m"][1].get<double>(), 99.98, 1e-6);
  EXPECT_EQ(Json::parse(ivory(folder, "info c.exr --json").out)["position_x_m"], 450000.5);
}

// An object at the origin of its file, put into the moved scene, hides what it hides in the other.
TEST(Far, ObjectsAndOccludersStandWhereTheyAreAskedFor) {
  const auto folder = scratch_folder("far_objects");
  const std::string object = scenes_folder + "knot.glb";
  expect_ok(folder, "bake fiv " + object + " --env " + scenes_folder +
                        "sky.hdr -o knot.exr --samples 8,5,4 --env-size 8 --parts 1 --silhouette 8");
  expect_ok(folder, "bake sh9 " + scenes_folder + "sky.hdr -o sky.json");
  Json first;
  for (const Shift& s : {here, national}) {
    write_below_root(folder / "plaza.gltf", "plaza.gltf", {{"translation", {s.x, s.y, s.z}}});
    const std::string common = "render plaza.gltf --size 16x12 --samples 1 --json --force -o a.exr --env " +
                               scenes_folder + "sky.hdr --object " + object + "@" + s.place(0.5, 0.25, 0.5);
    Json now;
    for (const std::string method : {" --method path", " --method fiv --occluder knot=knot.exr --ambient sky.json"}) {
      const Outcome outcome = ivory(folder, common + method);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
      now.push_back(Json::parse(outcome.out)["mean_radiance_nits"]);
    }
    if (first.is_null()) first = now;
    EXPECT_EQ(now, first);
  }
}

TEST(Scale, AsksForTheSameAgainAndIsHintedAt) {
  const auto folder = scratch_folder("scale");
  write_below_root(folder / "metres.gltf", "room_boxes.gltf", Json::object());
  write_below_root(folder / "cm.gltf", "room_boxes.gltf", {{"scale", {100, 100, 100}}});
  write_points(folder / "p.csv", here);
  const std::string bake = " --resolution 6 --photons 20k -o ";
  expect_ok(folder, "bake grid metres.gltf" + bake + "m.vdb");
  expect_ok(folder, "bake grid cm.gltf --scale 0.01" + bake + "cm.vdb");
  expect_ok(folder, "probe m.vdb --points p.csv -o m.csv --scene metres.gltf");
  expect_ok(folder, "probe cm.vdb --points p.csv -o cm.csv --scene cm.gltf --scale 0.01");
  EXPECT_EQ(light_of(folder / "cm.csv"), light_of(folder / "m.csv"));
  EXPECT_EQ(Json::parse(ivory(folder, "info cm.vdb --json").out)["scene_scale"], 0.01);
  EXPECT_FALSE(Json::parse(ivory(folder, "info m.vdb --json").out).contains("scene_scale"));
  expect_refused(folder, "probe cm.vdb --points p.csv -o x.csv -q --scene cm.gltf", 1, "give --scale 0.01");
  expect_refused(folder, "render cm.gltf --method direct --grid cm.vdb -o x.exr -q", 1, "give --scale 0.01");

  // A camera 170 m above the floor and a lamp of 6 cd in 504 m of darkness.
  const auto warnings = [&](const std::string& arguments) {
    return Json::parse(ivory(folder, "info --json " + arguments).out)["warnings"].dump();
  };
  EXPECT_NE(warnings("cm.gltf").find("centimetres"), std::string::npos) << warnings("cm.gltf");
  EXPECT_EQ(warnings("cm.gltf --scale 0.01"), "[]");
  EXPECT_EQ(warnings("metres.gltf"), "[]");
}

TEST(Scale, GridsThatCannotBeAreRefusedBeforeTheyAreBaked) {
  const auto folder = scratch_folder("scale_refusals");
  write_below_root(folder / "cm.gltf", "room_boxes.gltf", {{"scale", {100, 100, 100}}});
  expect_refused(folder, "bake grid cm.gltf -o x.vdb --voxel-size 0.2 -q", 2,
                 "--voxel-size: 2520x1420x2020 are 7.23e+09");
  write_below_root(folder / "speck.gltf", "room_boxes.gltf", {{"scale", {8e-6, 8e-6, 8e-6}}});
  expect_refused(folder, "bake grid speck.gltf -o x.vdb -q", 1, "cannot hold voxels of 1.3e-06");
}

}  // namespace

}  // namespace ivory::script
