// ivory probe: tables of points in, irradiance out.
#include <sstream>

#include "tests/tools/script.h"

namespace ivory::script {

namespace {

struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

Table read_csv(const fs::path& path) {
  const auto cells = [](const std::string& line) {
    std::vector<std::string> result;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) result.push_back(cell);
    return result;
  };
  std::ifstream file(path);
  Table table;
  std::string line;
  std::getline(file, line);
  table.header = cells(line);
  while (std::getline(file, line)) table.rows.push_back(cells(line));
  return table;
}

const std::string points_header = "x,y,z,nx,ny,nz\n";

TEST(Probe, KeepsColumnsAndNormalisesNormals) {
  const auto folder = scratch_folder("probe");
  ASSERT_EQ(ivory(folder, small_bake + "-o x.vdb").exit_code, 0);
  // The same point twice, with normals of other lengths, columns in another order, one of them foreign.
  write_file(folder / "p.csv",
             "\xEF\xBB\xBFname,nx,ny,nz,z,y,x\r\nfirst,0,1,0,0.3,0.2,0.1\r\nsecond,0, 1e-30 ,0,0.3,0.2,0.1\r\n\r\n");
  const Outcome outcome = ivory(folder, "probe x.vdb --points p.csv -o out.csv --json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(Json::parse(outcome.out)["points"], 2);
  EXPECT_EQ(Json::parse(outcome.out)["guard"], "planes");
  const Table table = read_csv(folder / "out.csv");
  const std::vector<std::string> header{"name", "nx", "ny", "nz", "z", "y", "x", "r", "g", "b", "r_se", "g_se", "b_se"};
  EXPECT_EQ(table.header, header);
  ASSERT_EQ(table.rows.size(), 2);
  EXPECT_EQ(table.rows[0][0], "first");
  for (std::size_t i = 7; i < 13; ++i) EXPECT_EQ(table.rows[0][i], table.rows[1][i]);
  EXPECT_EQ(Json::parse(ivory(folder, "probe x.vdb --points p.csv -o r.csv --json --scene " + scene).out)["guard"],
            "rays");
}

// A point inside, and one on the roof, which no vertex sees.
TEST(Probe, SaysWhatNoVertexSees) {
  const auto folder = scratch_folder("probe_unseen");
  ASSERT_EQ(ivory(folder, small_bake + "-o x.vdb").exit_code, 0);
  write_file(folder / "p.csv", points_header + "-2,0,1.5,0,1,0\n-2,3.02,1.5,0,1,0\n");
  for (const std::string& guard : {std::string(), " --scene " + scene}) {
    const Outcome outcome = ivory(folder, "probe x.vdb --points p.csv -o out.csv --force --json" + guard);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(Json::parse(outcome.out)["unseen"], 1) << guard;
    EXPECT_NE(outcome.err.find("1 of 2 points are seen by no vertex"), std::string::npos) << outcome.err;
    const Table table = read_csv(folder / "out.csv");
    EXPECT_GT(std::stod(table.rows.at(0).at(6)), 0) << guard;
    EXPECT_EQ(std::stod(table.rows.at(1).at(6)), 0) << guard;
  }
}

// The grid and the path tracer answer the same question. Both noises are known, the grid's error
// from its 8 vertices a side is not: it is held to a fifth of the mean over the points.
TEST(Probe, OfGridAndSceneAgree) {
  const auto folder = scratch_folder("probe_truth");
  const std::string points = std::string(source_folder) + "/scenes/leak_axis_lit_points.csv";
  ASSERT_EQ(ivory(folder, "bake grid " + scene + " --photons 400k -o x.vdb -q").exit_code, 0);
  ASSERT_EQ(ivory(folder, "probe x.vdb --points " + points + " -o grid.csv -q --scene " + scene).exit_code, 0);
  ASSERT_EQ(ivory(folder, "probe " + scene + " --points " + points + " -o truth.csv -q --indirect-only --samples 256")
                .exit_code,
            0);
  const Table grid = read_csv(folder / "grid.csv");
  const Table truth = read_csv(folder / "truth.csv");
  ASSERT_EQ(grid.rows.size(), truth.rows.size());
  double grid_mean = 0;
  double truth_mean = 0;
  for (std::size_t i = 0; i < grid.rows.size(); ++i) {
    grid_mean += std::stod(grid.rows[i][7]);
    truth_mean += std::stod(truth.rows[i][7]);
  }
  EXPECT_GT(truth_mean, 0);
  EXPECT_NEAR(grid_mean, truth_mean, 0.2 * truth_mean);
}

TEST(Probe, IsStrictAboutPoints) {
  const auto folder = scratch_folder("probe_points");
  ASSERT_EQ(ivory(folder, small_bake + "-o x.vdb").exit_code, 0);
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "line 1"},
      {"x,y,z,nx,ny\n0,0,0,0,1\n", "'nz'"},
      {points_header, "no points"},
      {points_header + "0,0,0,0,1,0\n0,0,0,0,1\n", "line 3 has 5 cells"},
      {points_header + "0,0,0,0,1,0,9\n", "line 2 has 7 cells"},
      {points_header + "0,0,zero,0,1,0\n", "line 2: 'zero' in column z"},
      {points_header + "0,0,,0,1,0\n", "line 2"},
      {points_header + "0,0,nan,0,1,0\n", "line 2: 'nan'"},
      {points_header + "0,0,1e99,0,1,0\n", "line 2: '1e99'"},
      {points_header + "0,0,0,0,0,0\n", "line 2: the normal is zero"},
      {points_header + "0,0,0,inf,0,0\n", "line 2: 'inf'"},
      {points_header + "0,0,0,0,1,0\n\n0,0,0,0,1,0\n", "line 3 is empty"},
      {"r,x,y,z,nx,ny,nz\n1,0,0,0,0,1,0\n", "already has a column 'r'"},
  };
  for (const auto& [text, message] : cases) {
    write_file(folder / "p.csv", text);
    expect_refused(folder, "probe x.vdb --points p.csv -o out.csv -q", 1, message);
  }
  EXPECT_FALSE(fs::exists(folder / "out.csv"));
}

TEST(Probe, RefusesOptionsThatWouldDoNothing) {
  const auto folder = scratch_folder("probe_options");
  ASSERT_EQ(ivory(folder, small_bake + "-o x.vdb").exit_code, 0);
  ASSERT_EQ(ivory(folder, small_bake + "-o sh9.vdb --basis sh9 --direct --guard off").exit_code, 0);
  write_file(folder / "p.csv", points_header + "0,1,0,0,1,0\n");
  const std::string tail = " --points p.csv -o out.csv -q ";
  expect_refused(folder, "probe x.vdb" + tail + "--samples 10", 2, "--samples");
  expect_refused(folder, "probe x.vdb" + tail + "--env a.exr", 2, "--env");
  expect_refused(folder, "probe x.vdb" + tail + "--guard rays", 2, "--scene");
  expect_refused(folder, "probe x.vdb" + tail + "--guard planes --scene " + scene, 2, "--scene");
  expect_refused(folder, "probe " + scene + tail + "--guard rays", 2, "--guard");
  expect_refused(folder, "probe " + scene + tail + "--samples 1", 2, "--samples");
  expect_refused(folder, "probe sh9.vdb" + tail + "--reconstruction paper", 2, "vectors");
  expect_refused(folder, "probe sh9.vdb" + tail + "--guard planes", 1, "guard");
  expect_refused(folder, "probe sh9.vdb" + tail + "--indirect-only", 1, "--direct");
}

// Of two rooms the one is dark, and so are the outsides of the walls.
TEST(Points, LieOnLitSurfacesWithinTheirBox) {
  const auto folder = scratch_folder("points");
  const std::string command = "points " + scene + " --count 200 --indirect-only --json --bounds=-2,-0.1,-1:1,2,1 ";
  ASSERT_EQ(ivory(folder, command + "-o p.csv --domain surfaces").exit_code, 0);
  ASSERT_EQ(ivory(folder, command + "-o again.csv --domain surfaces --threads 1").exit_code, 0);
  ASSERT_EQ(ivory(folder, command + "-o other.csv --domain surfaces --seed 2").exit_code, 0);
  EXPECT_EQ(read_file(folder / "p.csv"), read_file(folder / "again.csv"));
  EXPECT_NE(read_file(folder / "p.csv"), read_file(folder / "other.csv"));
  const Table table = read_csv(folder / "p.csv");
  ASSERT_EQ(table.rows.size(), 200);
  // A hundredth of a voxel about the box is within it: surfaces in its faces are the rule.
  constexpr double margin = 0.002;
  for (const std::vector<std::string>& row : table.rows) {
    const double x = std::stod(row[0]);
    const double y = std::stod(row[1]);
    EXPECT_TRUE(x > -2 - margin && x < 1 + margin && y > -0.1 - margin && y < 2 + margin) << x << " " << y;
  }
  // Light comes to all of them.
  ASSERT_EQ(ivory(folder, "probe " + scene + " --points p.csv -o e.csv --indirect-only --samples 256").exit_code, 0);
  for (const std::vector<std::string>& row : read_csv(folder / "e.csv").rows) EXPECT_GT(std::stod(row[6]), 0);
}

TEST(Points, SayWhereNoLightComes) {
  const auto folder = scratch_folder("points_dark");
  const Outcome outcome =
      ivory(folder, "points " + scene + " -o p.csv --count 20 --domain space --bounds=900,0,0:901,1,1");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_FALSE(fs::exists(folder / "p.csv"));
}

}  // namespace

}  // namespace ivory::script
