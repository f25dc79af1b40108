// ivory bake grid, merge and info: the same bytes from the same command, grids placed by hand.

#include <sstream>

#include "tests/tools/script.h"

namespace ivory::script {

namespace {

// One box each time: what follows is not swallowed.
TEST(BakeGrid, DynamicTakesOneBox) {
  const auto folder = scratch_folder("dynamic");
  const std::string tail = " " + scene + " -q -f --json --resolution 8 --photons 20k -o x.vdb";
  const auto stored = [&](const std::string& options) {
    const Outcome outcome = ivory(folder, "bake grid " + options + tail);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.exit_code == 0 ? Json::parse(outcome.out)["parameters"]["dynamic_regions"] : Json();
  };
  EXPECT_EQ(stored("--dynamic none"), "none");
  EXPECT_EQ(stored("--dynamic 0,0,0:0.5,1,1"), "0,0,0:0.5,1,1");
  EXPECT_EQ(stored("--dynamic 0,0,0:0.5,1,1 --dynamic -1,0,0:0,2,2"), "0,0,0:0.5,1,1 -1,0,0:0,2,2");
  EXPECT_EQ(stored(""), "everywhere");
}

TEST(BakeGrid, GridsArePlacedByHand) {
  const auto folder = scratch_folder("bounds");
  const Outcome outcome = ivory(
      folder, "bake grid " + scene +
                  " --bounds 0.2,0.1,0:-0.6,0.9,0.4 --rotate-y 90 --resolution 4 --photons 20k -o x.vdb -q --json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json result = Json::parse(outcome.out);
  // Turned by a quarter about (-0.2, 0.5, 0.2): local x is world -z, local z is world x.
  const double origin[3] = {-0.2 - 0.15, 0.5 - 0.3, 0.2 + 0.3};
  const double spacing[3] = {0.2, 0.2, 0.1};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(result["origin_m"][i].get<double>(), origin[i], 1e-6);
    EXPECT_NEAR(result["spacing_m"][i].get<double>(), spacing[i], 1e-6);
  }
  EXPECT_EQ(result["parameters"]["bounds"], "-0.6,0.1,0:0.2,0.9,0.4");
  EXPECT_EQ(result["parameters"]["rotate_y_deg"], 90);
  // Inside; half a voxel beyond the box's turned side; far away.
  write_file(folder / "p.csv",
             "x,y,z,nx,ny,nz\n-0.2,0.5,0.2,0,1,0\n-0.2,0.5,0.55,0,1,0\n0.1,0.5,0.2,0,1,0\n900,0,0,0,1,0\n");
  const Outcome probe = ivory(folder, "probe x.vdb --points p.csv -o e.csv --json");
  ASSERT_EQ(probe.exit_code, 0) << probe.err;
  EXPECT_EQ(Json::parse(probe.out)["outside"], 2);
  EXPECT_NE(probe.err.find("nearest vertices"), std::string::npos) << probe.err;
}

// Probes write the same kind of file, with how it was made, and refuse what serves photons alone.
TEST(BakeGrid, ProbesAreBakedIntoTheSameFile) {
  const auto folder = scratch_folder("probes");
  const std::string bake = "bake grid " + scene + " --by probes --resolution 4 -f -o x.vdb ";
  const Outcome outcome = ivory(folder, bake + "--probe-rays 64 --json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(Json::parse(outcome.out)["parameters"]["made_by"], "probes");
  const Outcome info = ivory(folder, "info x.vdb --json");
  EXPECT_NE(info.out.find("\"probe_rays\""), std::string::npos) << info.out;
  for (const std::string option :
       {"--photons 1k", "--direct", "--emission even", "--shards 2 --shard 1", "--target-error 5%"})
    EXPECT_EQ(ivory(folder, bake + option).exit_code, 2) << option;
  EXPECT_EQ(ivory(folder, "bake grid " + scene + " --resolution 4 -f -o x.vdb --probe-rays 64").exit_code, 2);
}

// Past the closed room, where none of its light comes: said in the result, on the terminal, in the file and where it is
// read, and with an error that is not 0.
TEST(BakeGrid, SaysWhereNoLightCame) {
  const auto folder = scratch_folder("unlit");
  const std::string bake = "bake grid " + scene + " --bounds 100,100,100:101,101,101 --resolution 2 --photons 20k -o ";
  const Outcome outcome = ivory(folder, bake + "x.vdb --json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string words = "nothing of the light reaches the grid";
  const Json result = Json::parse(outcome.out);
  ASSERT_EQ(result["warnings"].size(), 1);
  EXPECT_NE(result["warnings"][0].get<std::string>().find(words), std::string::npos);
  EXPECT_EQ(result["photons_a_vertex"]["none_share"], 1);
  EXPECT_NE(outcome.err.find(words), std::string::npos);
  const Json info = Json::parse(ivory(folder, "info x.vdb --json").out);
  EXPECT_NE(info["few_photons"].get<std::string>().find(words), std::string::npos);
  write_file(folder / "p.csv", "x,y,z,nx,ny,nz\n100.5,100.5,100.5,0,1,0\n");
  const Outcome probe = ivory(folder, "probe x.vdb --points p.csv -o e.csv --json");
  ASSERT_EQ(probe.exit_code, 0) << probe.err;
  EXPECT_EQ(Json::parse(probe.out)["unmet"], 1);
  EXPECT_NE(probe.err.find("no photon came"), std::string::npos) << probe.err;
  const std::string row = read_file(folder / "e.csv");
  // 3 P / (0.25 N) for cells with faces of a quarter of a square metre, and eight of them, half and half along x and z
  // and, a quarter voxel up, 1/4 and 3/4 along y: sqrt(1/2 1/2 5/8).
  const Json loaded = Json::parse(ivory(folder, "info " + scene + " --json").out);
  double power_lm = 0;
  for (const Json& channel : loaded["power_lm"]) power_lm += channel.get<double>();
  EXPECT_NEAR(std::stod(row.substr(row.rfind(',') + 1)), 3 * power_lm / (0.25 * 20'000) * std::sqrt(0.15625),
              0.05 * power_lm / 20'000);
  // A part says so of itself.
  EXPECT_NE(ivory(folder, bake + "a.vdb --photon-range 0:5k").err.find(words), std::string::npos);
  // And a path that meets no light knows nothing of its error.
  write_file(folder / "q.csv", "x,y,z,nx,ny,nz\n100.5,100.5,100.5,0,1,0\n");
  const Outcome paths = ivory(folder, "probe " + scene + " --points q.csv -o q_e.csv --samples 16 --json");
  ASSERT_EQ(paths.exit_code, 0) << paths.err;
  EXPECT_EQ(Json::parse(paths.out)["unmet"], 1);
  EXPECT_NE(read_file(folder / "q_e.csv").find(",0,0,0,,,\n"), std::string::npos) << read_file(folder / "q_e.csv");
}

class BakeBytes : public testing::TestWithParam<std::string> {};

TEST_P(BakeBytes, SameAtAnyThreadCountAndFromParts) {
  const auto folder = scratch_folder("bytes_" + std::to_string(std::hash<std::string>()(GetParam())));
  const std::string bake = "bake grid " + scene + " --resolution 9,7,6 --photons 100k -q " + GetParam();
  ASSERT_EQ(ivory(folder, bake + " -o one.vdb --threads 1").exit_code, 0);
  ASSERT_EQ(ivory(folder, bake + " -o two.vdb --threads 2").exit_code, 0);
  const std::string whole = read_file(folder / "one.vdb");
  EXPECT_EQ(whole, read_file(folder / "two.vdb"));

  ASSERT_EQ(ivory(folder, bake + " -o a.vdb --photon-range 0:33333").exit_code, 0);
  ASSERT_EQ(ivory(folder, bake + " -o b.vdb --photon-range 33333:34001 --threads 1").exit_code, 0);
  ASSERT_EQ(ivory(folder, bake + " -o c.vdb --photon-range 34001:100k --threads 2").exit_code, 0);
  ASSERT_EQ(ivory(folder, "merge c.vdb a.vdb b.vdb -o merged.vdb -q").exit_code, 0);
  EXPECT_EQ(whole, read_file(folder / "merged.vdb"));

  // In two steps, the first of which is not complete and says so.
  const Outcome half = ivory(folder, "merge b.vdb a.vdb -o ab.vdb --json");
  ASSERT_EQ(half.exit_code, 0);
  EXPECT_EQ(Json::parse(half.out)["complete"], false);
  const Outcome rest = ivory(folder, "merge ab.vdb c.vdb -o abc.vdb --json");
  ASSERT_EQ(rest.exit_code, 0);
  EXPECT_EQ(Json::parse(rest.out)["complete"], true);
  EXPECT_EQ(whole, read_file(folder / "abc.vdb"));

  ASSERT_EQ(ivory(folder, bake + " -o other.vdb --seed 2").exit_code, 0);
  EXPECT_NE(whole, read_file(folder / "other.vdb"));
}

INSTANTIATE_TEST_SUITE_P(Options, BakeBytes,
                         testing::Values("", "--basis sh9", "--basis vectors9 --direct", "--basis ambient_cube",
                                         "--basis sh4 --guard off", "--estimator face", "--estimator face_paper",
                                         "--levels 2", "--levels 3 --basis sh9 --dynamic none"));

// Fine near surfaces, coarse in the open: what the result, the file and look-ups say of it.
TEST(BakeGrid, LevelsStandSideBySide) {
  const auto folder = scratch_folder("levels");
  const std::string bake = "bake grid " + scene + " --voxel-size 0.1 --photons 20k -q -f --json -o ";
  const Json uniform = Json::parse(ivory(folder, bake + "a.vdb").out);
  const Outcome outcome = ivory(folder, bake + "b.vdb --levels 3");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json levels = Json::parse(outcome.out);
  EXPECT_LT(levels["vertices"].get<int>(), uniform["vertices"].get<int>());
  ASSERT_EQ(levels["levels"].size(), 3);
  int vertices = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(levels["levels"][i]["spacing_m"][0].get<double>(), 0.4 / (1 << i), 1e-6);
    vertices += levels["levels"][i]["vertices"].get<int>();
  }
  EXPECT_EQ(vertices, levels["vertices"].get<int>());
  EXPECT_NEAR(levels["spacing_m"][0].get<double>(), 0.1, 1e-6);
  const Json info = Json::parse(ivory(folder, "info b.vdb --json").out);
  EXPECT_EQ(info["levels"], 3);
  EXPECT_EQ(info["active_vertices"], levels["vertices_stored"]);
  EXPECT_EQ(info["level_spacings_m"], "0.4 0.2 0.1");
  EXPECT_FALSE(uniform.contains("levels"));
  EXPECT_FALSE(Json::parse(ivory(folder, "info a.vdb --json").out).contains("levels"));
  for (const std::string& guard : {std::string(), std::string(" --guard off"), " --scene " + scene}) {
    const std::string points = " --points " + std::string(source_folder) + "/scenes/leak_axis_lit_points.csv -o ";
    ASSERT_EQ(ivory(folder, "probe b.vdb" + points + "e.csv -f -q" + guard).exit_code, 0) << guard;
  }
  // Parts of other levels are other bakes'.
  const std::string part = "bake grid " + scene + " --voxel-size 0.3 --photons 20k -q -f -o ";
  ASSERT_EQ(ivory(folder, part + "p.vdb --photon-range 0:10k --levels 2").exit_code, 0);
  ASSERT_EQ(ivory(folder, part + "q.vdb --photon-range 10k:20k --levels 3").exit_code, 0);
  expect_refused(folder, "merge p.vdb q.vdb -o x.vdb", 1, "level");
  expect_refused(folder, part + "x.vdb --levels 2 --estimator face", 2, "estimator");
  expect_refused(folder, "bake grid " + scene + " --levels 2 -o x.vdb", 2, "--voxel-size");
  expect_refused(folder, part + "x.vdb --levels 0", 2, "--levels");
}

TEST(BakeGrid, MergeRefusesPartsThatDoNotFit) {
  const auto folder = scratch_folder("merge");
  const auto part = [&](const std::string& file, const std::string& options) {
    ASSERT_EQ(ivory(folder, small_bake + "-o " + file + " " + options).exit_code, 0);
  };
  part("a.vdb", "--photon-range 0:5000");
  part("overlap.vdb", "--photon-range 4999:20000");
  part("gap.vdb", "--photon-range 5001:20000");
  part("seed.vdb", "--photon-range 5000:20000 --seed 2");
  part("whole.vdb", "");
  // Both guards are baked alike.
  part("rays.vdb", "--photon-range 5000:20000 --guard rays");
  part("planes.vdb", "--photon-range 0:5000 --guard planes");
  EXPECT_EQ(ivory(folder, "merge rays.vdb planes.vdb -o guards.vdb -q").exit_code, 0);
  EXPECT_EQ(read_file(folder / "guards.vdb"), read_file(folder / "whole.vdb"));
  expect_refused(folder, "merge a.vdb overlap.vdb -o x.vdb", 1, "overlap");
  expect_refused(folder, "merge a.vdb a.vdb -o x.vdb", 1, "overlap");
  expect_refused(folder, "merge a.vdb gap.vdb -o x.vdb", 1, "missing");
  expect_refused(folder, "merge a.vdb seed.vdb -o x.vdb", 1, "seed");
  expect_refused(folder, "merge whole.vdb -o x.vdb", 1, "finished grid");
  expect_refused(folder, "probe a.vdb --points x -o x.csv", 1, "x");
  EXPECT_FALSE(fs::exists(folder / "x.vdb"));
}

// By one spacing and by several, in one go and in parts.
TEST(BakeGrid, GroupsOfLightsAreMixedAfterTheBake) {
  const auto folder = scratch_folder("groups");
  const std::string rooms = std::string(source_folder) + "/scenes/two_rooms.gltf";
  const std::string sky = std::string(source_folder) + "/scenes/sky.hdr";
  for (const std::string spacing : {"--resolution 4,3,9 ", "--voxel-size 0.5 --levels 2 "}) {
    const std::string bake = "bake grid " + rooms + " --env " + sky + " --photons 40k -q -f " + spacing;
    const std::string groups = "--groups sky=@environment --groups extras ";
    ASSERT_EQ(ivory(folder, bake + "-o whole.vdb").exit_code, 0);
    const Outcome grouped = ivory(folder, bake + groups + "-o groups.vdb --json");
    ASSERT_EQ(grouped.exit_code, 0) << grouped.err;
    const Json shares = Json::parse(grouped.out)["groups"];
    ASSERT_EQ(shares.size(), 2);
    EXPECT_EQ(shares[0]["name"], "sky");
    EXPECT_EQ(shares[1]["name"], "rest");
    EXPECT_NEAR(shares[0]["share"].get<double>() + shares[1]["share"].get<double>(), 1, 1e-9);
    EXPECT_EQ(Json::parse(ivory(folder, "info groups.vdb --json").out)["light_groups"], "sky rest");
    for (const std::string range : {"0:9000", "9000:40000"})
      ASSERT_EQ(
          ivory(folder, bake + groups + "--photon-range " + range + " -o " + range.substr(0, 1) + ".vdb").exit_code, 0);
    EXPECT_EQ(ivory(folder, "merge 0.vdb 9.vdb -q -f -o merged.vdb").exit_code, 0);
    EXPECT_EQ(read_file(folder / "merged.vdb"), read_file(folder / "groups.vdb"));
    // Untouched, it is the whole; all of it dimmed, the whole dimmed.
    EXPECT_EQ(ivory(folder, "mix groups.vdb -q -f -o mixed.vdb --scale rest=1 --tint sky=1,1,1").exit_code, 0);
    EXPECT_EQ(read_file(folder / "mixed.vdb"), read_file(folder / "whole.vdb"));
    EXPECT_EQ(
        ivory(folder, "mix groups.vdb -q -f -o half.vdb --scale sky=0.5 --scale rest=2 --tint rest=0.25,1,0").exit_code,
        0);
    EXPECT_EQ(Json::parse(ivory(folder, "info half.vdb --json").out)["mix"], "sky=0.5,0.5,0.5 rest=0.5,2,0");
    EXPECT_EQ(ivory(folder, "mix groups.vdb -q -f -o rest.vdb --scale sky=0").exit_code, 0);
    write_file(folder / "p.csv", "x,y,z,nx,ny,nz\n0,1,0,0,1,0\n");
    const auto e = [&](const std::string& grid) {
      const Outcome probe = ivory(folder, "probe " + grid + " --points p.csv -q -f -o e.csv");
      EXPECT_EQ(probe.exit_code, 0) << probe.err;
      const std::string text = read_file(folder / "e.csv");
      std::istringstream cells(text.substr(text.find('\n') + 1));
      std::vector<double> values;
      for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::stod(cell));
      return std::vector<double>(values.begin() + 6, values.begin() + 9);
    };
    // The rooms are closed: all of it is the lamp's, but for the rounding of floats on the way through the file.
    const std::vector<double> whole = e("whole.vdb");
    const std::vector<double> half = e("half.vdb");
    EXPECT_GT(whole[0], 0);
    EXPECT_NEAR(half[0], 0.5 * whole[0], 1e-5 * whole[0]);
    EXPECT_NEAR(half[1], 2 * whole[1], 1e-5 * whole[1]);
    EXPECT_EQ(half[2], 0);
    EXPECT_NEAR(e("rest.vdb")[0], whole[0], 1e-5 * whole[0]);
  }
  expect_refused(folder, "mix whole.vdb -o x.vdb", 1, "--groups");
  expect_refused(folder, "mix groups.vdb -o x.vdb --scale hall=1", 1, "sky, rest");
  expect_refused(folder, "mix groups.vdb -o x.vdb --scale sky=-1", 2, "--scale");
  expect_refused(folder, "mix groups.vdb -o x.vdb --scale sky", 2, "--scale");
  expect_refused(folder, "mix groups.vdb -o x.vdb --tint sky=1,nan,1", 2, "--tint");
  expect_refused(folder, "bake grid " + rooms + " -o x.vdb --resolution 4 --groups sky=@environment", 2, "--groups");
  expect_refused(folder, "bake grid " + rooms + " -o x.vdb --resolution 4 --groups sky", 2, "--groups");
  EXPECT_FALSE(fs::exists(folder / "x.vdb"));
}

TEST(BakeGrid, InfoTellsHowAGridWasBaked) {
  const auto folder = scratch_folder("info");
  ASSERT_EQ(ivory(folder, small_bake + "-o x.vdb --seed 7 --bounces 5").exit_code, 0);
  const Json grid = Json::parse(ivory(folder, "info x.vdb --json").out);
  EXPECT_EQ(grid["kind"], "irradiance grid");
  EXPECT_EQ(grid["size"], Json::array({8, 8, 8}));
  EXPECT_EQ(grid["seed"], 7);
  EXPECT_EQ(grid["max_bounces"], 5);
  EXPECT_EQ(grid["photons"], 20000);
  EXPECT_EQ(grid["photon_begin"], 0);
  EXPECT_EQ(grid["photon_end"], 20000);
  EXPECT_EQ(grid["scene"], "leak_axis.gltf");
  EXPECT_TRUE(grid["version"].is_string());  // compared by merge
  const Json loaded = Json::parse(ivory(folder, "info " + scene + " --json").out);
  EXPECT_EQ(grid["scene_hash"], loaded["content_hash"]);
  EXPECT_EQ(loaded["kind"], "scene");
  EXPECT_GT(loaded["triangles"], 0);
  EXPECT_GT(loaded["power_lm"][0], 0);
}

}  // namespace

}  // namespace ivory::script
