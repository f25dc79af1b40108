// ivory batch: what is baked, and when it is baked again.
#include "tests/tools/batch/batch_test.h"

namespace ivory {
namespace {

// A grid, what reads it, a table and spheres of meshes: less than a second in all.
const std::string job = R"(
[job]
output = "baked"
[variables]
size = 6
[scene.box]
file = "cornell_box.gltf"
[environment.sky]
file = "sky.hdr"
[default.grid]
photons = "4k"
[grid.box]
scene = "box"
resolution = "${size}"
[cubemap.box]
scene = "box"
at = [0.25, "30 cm", 0.25]
grid = "box"
capture = 8
samples = 2
[render.box]
scene = "box"
method = "direct"
grid = "grid.box"
size = "16x16"
samples = 1
[fiv.box]
mesh = "cornell_box.gltf"
env = "sky"
samples = [3, 3, 2]
parts = 1
silhouette = 8
env_size = 4
[spheres.tile]
mesh = "tile.gltf"
count = 1
resolution = 16
)";

class Batch : public BatchTest {
 protected:
  void SetUp() override {
    BatchTest::SetUp();
    write("job.toml", job);
  }
  States all(const std::string& state) const {
    return {{"grid.box", state},
            {"cubemap.box", state},
            {"render.box", state},
            {"fiv.box", state},
            {"spheres.tile", state}};
  }
  States but(std::initializer_list<const char*> assets, const std::string& state) const {
    States states = all("fresh");
    for (const char* asset : assets) states[asset] = state;
    return states;
  }
};

// The same files as their commands write, to the byte; and nothing is baked twice.
TEST_F(Batch, BakesWhatTheCommandsBakeOnce) {
  EXPECT_EQ(states(), all("baked"));
  EXPECT_EQ(states(), all("fresh"));
  const std::string folder = folder_.string();
  const auto same = [&](const std::string& file, const std::string& command) {
    const std::string other = "by_hand" + std::filesystem::path(file).extension().string();
    const std::string line = "cd " + folder + " && " + ivory_binary + " " + command + " -q -f -o " + other;
    ASSERT_EQ(std::system(line.c_str()), 0) << line;
    EXPECT_EQ(bytes_of(path("baked/" + file)), bytes_of(path(other))) << file;
  };
  same("box.grid.vdb", "bake grid cornell_box.gltf --photons 4k --resolution 6");
  same("box.cubemap.exr",
       "bake cubemap cornell_box.gltf --at 0.25,0.3,0.25 --grid baked/box.grid.vdb --capture 8 --samples 2");
  same("box.render.png", "render cornell_box.gltf --method direct --grid baked/box.grid.vdb --size 16x16 --samples 1");
  same("box.fiv.exr", "bake fiv cornell_box.gltf --env sky.hdr --samples 3,3,2 --parts 1 --silhouette 8 --env-size 4");
  same("tile.spheres.json", "bake spheres tile.gltf --count 1 --resolution 16");
}

// Side by side, one after the other, on one thread or more.
TEST_F(Batch, BytesDoNotDependOnTheOrder) {
  EXPECT_EQ(states("--side-by-side 4"), all("baked"));
  const std::vector<std::string> files{"box.grid.vdb", "box.cubemap.exr", "box.render.png", "box.fiv.exr",
                                       "tile.spheres.json"};
  std::vector<std::string> first;
  for (const std::string& file : files) first.push_back(bytes_of(path("baked/" + file)));
  std::filesystem::remove_all(path("baked"));
  EXPECT_EQ(states("--side-by-side 1 --threads 1"), all("baked"));
  for (std::size_t i = 0; i < files.size(); ++i) EXPECT_EQ(bytes_of(path("baked/" + files[i])), first[i]) << files[i];
}

TEST_F(Batch, BakesAgainWhatAChangeTouches) {
  EXPECT_EQ(states(), all("baked"));
  nlohmann::json scene = read_scene();

  // White space, a comment, names of what is seen.
  scene["asset"]["extras"] = "a comment";
  scene["materials"][0]["name"] = "another name";
  write_scene(scene);
  EXPECT_EQ(states(), all("fresh"));

  // A camera: pictures alone.
  scene["cameras"][0]["perspective"]["yfov"] = 0.5;
  write_scene(scene);
  EXPECT_NE(batch("--explain render.box").output.find("camera 'published' changed"), std::string::npos);
  EXPECT_EQ(states(), but({"render.box"}, "baked"));

  // A material: what is made from the scene.
  scene["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"][0] = 0.01;
  write_scene(scene);
  EXPECT_NE(batch("--explain grid.box").output.find("material 'green' changed"), std::string::npos)
      << batch("--explain grid.box").output;
  EXPECT_EQ(states(), but({"grid.box", "cubemap.box", "render.box"}, "baked"));

  // A lamp that is moved.
  scene["nodes"].push_back(
      {{"name", "spot"}, {"translation", {0.2, 0.4, 0.2}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  scene["scenes"][0]["nodes"].push_back(scene["nodes"].size() - 1);
  scene["extensionsUsed"].push_back("KHR_lights_punctual");
  scene["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 3}}};
  write_scene(scene);
  EXPECT_EQ(states(), but({"grid.box", "cubemap.box", "render.box"}, "baked"));
  scene["nodes"].back()["translation"] = {0.3, 0.4, 0.2};
  write_scene(scene);
  EXPECT_NE(batch("--explain grid.box").output.find("light 'spot' changed"), std::string::npos);
  EXPECT_EQ(states(), but({"grid.box", "cubemap.box", "render.box"}, "baked"));

  // An option of one asset: that, and what reads its file if that has changed.
  std::string changed = job;
  changed.replace(changed.find("capture = 8"), 11, "capture = 16");
  write("job.toml", changed);
  EXPECT_NE(batch("--explain cubemap.box").output.find("option capture changed from '8' to '16'"), std::string::npos);
  EXPECT_EQ(states(), but({"cubemap.box"}, "baked"));

  // A file that is gone.
  std::filesystem::remove(path("baked/tile.spheres.json"));
  EXPECT_EQ(states(), but({"spheres.tile"}, "baked"));

  // A level that is moved as a whole.
  const std::filesystem::path moved = folder_ / "moved";
  std::filesystem::create_directory(moved);
  for (const char* name : {"baked", "cornell_box.gltf", "sky.hdr", "tile.gltf", "job.toml"})
    std::filesystem::rename(folder_ / name, moved / name);
  EXPECT_EQ(run_ivory("batch " + (moved / "job.toml").string() + " --quiet").output, "");
  EXPECT_NE(run_ivory("batch " + (moved / "job.toml").string()).output.find("5 fresh"), std::string::npos);
}

// The grid is baked again to the same bytes, so nothing that reads it is.
TEST_F(Batch, StopsWhereNothingComesOutDifferent) {
  EXPECT_EQ(states(), all("baked"));
  std::filesystem::remove(path("baked/box.grid.vdb"));
  EXPECT_EQ(states(), but({"grid.box"}, "baked"));
}

TEST_F(Batch, AFailureStopsWhatNeedsIt) {
  std::string broken = job;
  broken.replace(broken.find("resolution = \"${size}\""), 22, "resolution = 6\ngroups = [\"hall=None*\"]");
  write("job.toml", broken);
  const auto ended = lines();
  EXPECT_EQ(ended.at("grid.box")["state"], "failed");
  EXPECT_NE(ended.at("grid.box")["error"], "");
  EXPECT_EQ(ended.at("cubemap.box")["state"], "skipped");
  EXPECT_EQ(ended.at("render.box")["state"], "skipped");
  EXPECT_EQ(ended.at("fiv.box")["state"], "baked");
  EXPECT_EQ(ended.at("spheres.tile")["state"], "baked");
  const RunResult again = batch("--json");
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_NE(again.output.find("failed: grid.box"), std::string::npos) << again.output;
  EXPECT_FALSE(std::filesystem::exists(path("baked/box.grid.vdb")));
  // Mended, what is missing is baked.
  write("job.toml", job);
  EXPECT_EQ(states(), (States{{"grid.box", "baked"},
                              {"cubemap.box", "baked"},
                              {"render.box", "baked"},
                              {"fiv.box", "fresh"},
                              {"spheres.tile", "fresh"}}));
}

// What is known to fail stops all, or with --keep-going what needs it.
TEST_F(Batch, ABrokenSceneStopsAllUnlessToldToGoOn) {
  write("tile.gltf", "no scene");
  const RunResult stopped = batch();
  EXPECT_EQ(stopped.exit_code, 1);
  EXPECT_EQ(std::count(stopped.output.begin(), stopped.output.end(), '\n'), 1) << stopped.output;
  EXPECT_FALSE(std::filesystem::exists(path("baked")));
  States ended = all("baked");
  ended["spheres.tile"] = "failed";
  EXPECT_EQ(states("--keep-going"), ended);
}

TEST_F(Batch, OverwritesItsOwnFilesOnly) {
  write("baked/box.grid.vdb", "somebody's");
  EXPECT_EQ(batch().exit_code, 1);
  EXPECT_NE(batch().output.find("--force"), std::string::npos) << batch().output;
  EXPECT_EQ(bytes_of(path("baked/box.grid.vdb")), "somebody's");
  EXPECT_EQ(states("--force"), all("baked"));
  write("baked/tile.spheres.json", "edited");
  EXPECT_EQ(batch().exit_code, 1);
  EXPECT_EQ(states("--force"), but({"spheres.tile"}, "baked"));
}

TEST_F(Batch, OnlySomeAndWhatTheyNeed) {
  EXPECT_EQ(states("--only 'cubemap.*'"), (States{{"grid.box", "baked"}, {"cubemap.box", "baked"}}));
  EXPECT_EQ(states("--only tile --only fiv.*"), (States{{"fiv.box", "baked"}, {"spheres.tile", "baked"}}));
  EXPECT_EQ(states(), but({"render.box"}, "baked"));
}

TEST_F(Batch, DryRunBakesNothingAndForetells) {
  const auto planned = lines("--dry-run");
  EXPECT_EQ(planned.size(), 5U);
  EXPECT_EQ(planned.at("grid.box")["state"], "stale");
  EXPECT_GT(planned.at("grid.box")["seconds"]["expected"].get<double>(), 0);
  EXPECT_GT(planned.at("grid.box")["memory_bytes"]["expected"].get<double>(), 0);
  EXPECT_GT(planned.at("fiv.box")["seconds"]["expected"].get<double>(), 0);
  EXPECT_FALSE(std::filesystem::exists(path("baked")));
  EXPECT_EQ(states(), all("baked"));
  for (const auto& [asset, line] : lines("--dry-run")) EXPECT_EQ(line["state"], "fresh") << asset;
}

TEST_F(Batch, ListsInAnOrderThatCanBeBaked) {
  const std::string text = batch("--list").output;
  EXPECT_LT(text.find("grid.box:"), text.find("cubemap.box:")) << text;
  EXPECT_NE(text.find("render.box: baked/box.render.png, needs grid.box"), std::string::npos) << text;
}

TEST_F(Batch, VariablesMayBeSetForOneRun) {
  const auto listed = lines("--list --set size=9");
  EXPECT_NE(listed.at("grid.box")["command"].dump().find("--resolution=9"), std::string::npos);
}

// Units, includes, patterns over files and nodes.
TEST_F(Batch, OneSectionForManyAssets) {
  std::filesystem::create_directories(path("props"));
  std::filesystem::copy_file(path("tile.gltf"), path("props/one.gltf"));
  std::filesystem::copy_file(path("tile.gltf"), path("props/two.gltf"));
  write("shared/common.toml", "[variables]\nfine = \"25 cm\"\n[environment.sky]\nfile = \"../sky.hdr\"\n");
  write("job.toml", R"(include = ["shared/common.toml"]
[scene.rooms]
file = "cornell_box.gltf"
scale = 10
[spheres.props]
each = "props/*.gltf"
mesh = "${file}"
count = 2
[grid.parts]
each = { scene = "rooms", nodes = "*box", margin = "50 cm" }
scene = "rooms"
env = "sky"
bounds = "${bounds}"
voxel_size = "${fine}"
)");
  const auto listed = lines("--list");
  EXPECT_EQ(listed.at("spheres.props.one")["command"][2], "props/one.gltf");
  EXPECT_EQ(listed.at("spheres.props.two")["outputs"][0], "props.two.spheres.json");
  ASSERT_TRUE(listed.contains("grid.parts.cornell_box")) << batch("--list").output;
  const std::string command = listed.at("grid.parts.cornell_box")["command"].dump();
  EXPECT_NE(command.find("--voxel-size=0.25"), std::string::npos) << command;
  EXPECT_NE(command.find("--scale=10"), std::string::npos) << command;
  EXPECT_NE(command.find("--env=sky.hdr"), std::string::npos) << command;
  EXPECT_NE(command.find("--bounds=-0.5,-0.5,-0.5:6."), std::string::npos) << command;
}

// Of files, by names of assets, and by what the scene itself names.
TEST_F(Batch, FindsWhatAssetsNeed) {
  nlohmann::json scene = read_scene();
  scene["nodes"][0]["extras"]["ivory_occluder"] = "tables/box.exr";
  write_scene(scene);
  write("job.toml", R"([grid.a]
scene = "cornell_box.gltf"
resolution = 4
output = "grids/a.vdb"
[mix.b]
grid = "a"
[render.c]
scene = "cornell_box.gltf"
method = "direct"
grid = "grids/a.vdb"
[fiv.d]
mesh = "tile.gltf"
env = "sky.hdr"
output = "tables/box.exr"
[render.e]
scene = "cornell_box.gltf"
env = "sky.hdr"
method = "fiv"
ambient = "sky"
[difmap.sky]
environment = "sky.hdr"
[merge.all]
parts = ["grid.*"]
[export.all]
to = "three.js"
output = "all.ktx2"
asset = "merge.all"
)");
  const auto listed = lines("--list");
  const auto needs = [&](const char* asset) { return listed.at(asset)["needs"]; };
  EXPECT_EQ(needs("grid.a"), nlohmann::json::array());
  EXPECT_EQ(needs("mix.b"), nlohmann::json({"grid.a"}));
  EXPECT_EQ(needs("render.c"), nlohmann::json({"grid.a"}));
  EXPECT_EQ(needs("render.e"), nlohmann::json({"fiv.d", "difmap.sky"}));
  EXPECT_EQ(needs("merge.all"), nlohmann::json({"grid.a"}));
  EXPECT_EQ(needs("export.all"), nlohmann::json({"merge.all"}));
  EXPECT_EQ(listed.at("export.all")["outputs"], nlohmann::json({"all.ktx2", "all.js", "all.json"}));
}

// A batch that is killed goes on, to the same bytes.
TEST_F(Batch, GoesOnAfterItIsKilled) {
  EXPECT_EQ(states(), all("baked"));
  const std::vector<std::string> files{"box.grid.vdb", "box.cubemap.exr", "box.render.png", "box.fiv.exr",
                                       "tile.spheres.json"};
  std::vector<std::string> whole;
  for (const std::string& file : files) whole.push_back(bytes_of(path("baked/" + file)));
  std::filesystem::remove_all(path("baked"));
  for (const char* seconds : {"0.05", "0.15", "0.3", "0.5", "0.8"}) {
    const std::string line = std::string("timeout -s KILL ") + seconds + " " + ivory_binary + " batch " +
                             path("job.toml") + " -q > /dev/null 2>&1";
    [[maybe_unused]] const int ended = std::system(line.c_str());
  }
  const auto last = states();
  for (const auto& [asset, state] : last) EXPECT_TRUE(state == "baked" || state == "fresh") << asset << " " << state;
  for (std::size_t i = 0; i < files.size(); ++i) EXPECT_EQ(bytes_of(path("baked/" + files[i])), whole[i]) << files[i];
}

TEST_F(Batch, WritesAFirstJobThatIsOne) {
  EXPECT_EQ(run_ivory("batch " + path("first.toml") + " --init " + path("cornell_box.gltf") + " -q").output, "");
  const RunResult listed = run_ivory("batch " + path("first.toml") + " --list");
  EXPECT_EQ(listed.exit_code, 0) << listed.output;
  EXPECT_NE(listed.output.find("grid.cornell_box: baked/cornell_box.grid.vdb"), std::string::npos) << listed.output;
  EXPECT_NE(listed.output.find("render.published:"), std::string::npos) << listed.output;
  EXPECT_NE(bytes_of(path("first.toml")).find("camera = \"published\""), std::string::npos);
}

TEST_F(Batch, ADamagedRecordIsSaid) {
  EXPECT_EQ(states("--only spheres.tile"), (States{{"spheres.tile", "baked"}}));
  write("baked/job.batch.json", "{}");
  expect_one_line("batch " + path("job.toml"), 1, "job.batch.json: is no record of a batch");
}

}  // namespace
}  // namespace ivory
