// The binary as scripts meet it: exit codes, one-line errors, results as JSON, whole files or none.
#include "tests/support/run_ivory.h"
#include "tests/tools/script.h"

namespace ivory::script {

namespace {

TEST(Cli, HelpTeaches) {
  const auto folder = scratch_folder("help");
  const Outcome all = ivory(folder, "--help");
  EXPECT_EQ(all.exit_code, 0);
  // Every command in the list of a page has a page of its own.
  std::vector<std::string> commands = listed_commands(all.out);
  EXPECT_GE(commands.size(), 6);
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const std::string command = commands[i];
    const Outcome help = ivory(folder, command + " --help");
    EXPECT_EQ(help.exit_code, 0) << command;
    EXPECT_EQ(help.err, "") << command;
    EXPECT_NE(help.out.find("Usage: ivory " + command), std::string::npos) << help.out;
    const std::vector<std::string> below = listed_commands(help.out);
    for (const std::string& name : below) commands.push_back(command + " " + name);
    if (!below.empty()) continue;
    for (const char* shared : {"--threads", "--json", "--quiet"})
      EXPECT_NE(help.out.find(shared), std::string::npos) << command << " lacks " << shared;
    EXPECT_NE(help.out.find("\n  ivory " + command), std::string::npos) << command << " shows no example";
  }
  EXPECT_TRUE(ivory(folder, "--version").out.starts_with("ivory "));
}

TEST(Cli, UsageErrorsExitWith2) {
  const auto folder = scratch_folder("usage");
  for (const std::string& arguments :
       {std::string(), std::string("bake"), std::string("nonsense"), std::string("info"), std::string("--nonsense"),
        std::string("merge -o x.vdb"), "bake grid " + scene, "bake grid " + scene + " -o x.exr",
        std::string("merge x.vdb -o x"), "info " + scene + " --threads 0", "info " + scene + " --threads x",
        "info " + scene + " extra"})
    expect_refused(folder, arguments, 2, "");
  const std::string bake = "bake grid " + scene + " -o x.vdb ";
  for (const char* wrong : {"--photons 0x10",
                            "--photons -5",
                            "--photons 8q",
                            "--photons ''",
                            "--photons 1.5",
                            "--photons 0.0001k",
                            "--photons 99999999999g",
                            "--photons 18446744073709551616",
                            "--photons nan",
                            "--photon-range 5:5",
                            "--photon-range 7:5",
                            "--photon-range 5",
                            "--photon-range 1:2:3",
                            "--photon-range :5",
                            "--resolution 1",
                            "--resolution 8,8",
                            "--resolution 8,8,8,8",
                            "--resolution 8,8,1",
                            "--resolution 8,8,70000",
                            "--resolution a",
                            "--resolution 8,,8",
                            "--voxel-size 0",
                            "--voxel-size -1",
                            "--voxel-size nan",
                            "--resolution 8 --voxel-size 0.1",
                            "--basis none",
                            "--estimator none",
                            "--guard none",
                            "--bounces 0",
                            "--bounces 2m",
                            "--photons 0",
                            "--bounds 0,0,0",
                            "--bounds 0,0,0:1,1",
                            "--bounds 0,0,0:1,0,1",
                            "--bounds -3e38,0,0:3e38,1,1",
                            "--rotate-y nan",
                            "--rotate-y 1000",
                            "--dynamic none --dynamic 0,0,0:1,1,1",
                            "--seed -1",
                            "--estimator face --basis sh9",
                            "--photons 100 --photon-range 50:101"})
    expect_refused(folder, bake + wrong, 2, "");
  EXPECT_TRUE(names_in(folder).empty());
}

TEST(Cli, CountsTakeSuffixes) {
  const auto folder = scratch_folder("counts");
  const std::vector<std::pair<std::string, int>> cases{{"1000", 1000}, {"2k", 2000}, {"1.5K", 1500}, {"0.003m", 3000}};
  for (const auto& [text, count] : cases) {
    const Outcome outcome =
        ivory(folder, "bake grid " + scene + " -o x.vdb -f --json --resolution 2 --photons " + text);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(Json::parse(outcome.out)["photons"], count) << text;
  }
}

TEST(Cli, EveryCountTakesSuffixes) {
  const auto folder = scratch_folder("suffixes");
  const Outcome grid = ivory(folder, small_bake + "-o x.vdb --json --bounces 0.004k");
  ASSERT_EQ(grid.exit_code, 0) << grid.err;
  EXPECT_EQ(Json::parse(grid.out)["parameters"]["max_bounces"], 4);
  write_file(folder / "p.csv", "x,y,z,nx,ny,nz\n0,1,0,0,1,0\n");
  for (const std::string& command :
       {small_bake + "-o y.VDB", "probe " + scene + " --points p.csv -o b.csv --samples 4 --bounces 1k",
        "bake cubemap " + scene + " --at 0,1,0 --capture 4 --samples 0.01k -o c.exr"}) {
    const Outcome outcome = ivory(folder, command + " -q");
    EXPECT_EQ(outcome.exit_code, 0) << command << outcome.err;
  }
}

TEST(Cli, BadInputExitsWith1AndLeavesNothing) {
  const auto folder = scratch_folder("bad_input");
  write_file(folder / "text.gltf", "not json");
  write_file(folder / "text.vdb", std::string(500, 'x'));
  write_file(folder / "text.exr", std::string(500, 'x'));
  write_file(folder / "p.csv", "x,y,z,nx,ny,nz\n0,1,0,0,1,0\n");
  write_file(folder / "empty.gltf", R"({"asset":{"version":"2.0"}})");
  fs::create_directory(folder / "folder.vdb");
  const auto before = names_in(folder);
  const std::vector<std::pair<std::string, std::string>> cases{
      {"bake grid missing.gltf -o x.vdb", "missing.gltf"},
      {"bake grid text.gltf -o x.vdb", "text.gltf"},
      {"bake grid empty.gltf -o x.vdb", "empty.gltf"},
      {"bake grid " + scene + " -o missing/x.vdb", "missing/x.vdb"},
      {"bake grid " + scene + " -o folder.vdb", "folder.vdb"},
      {"bake grid " + scene + " -o x.vdb --env missing.exr", "missing.exr"},
      {"bake grid " + scene + " -o x.vdb --env text.exr", "text.exr"},
      {"bake grid " + scene + " -o x.vdb --resolution 1200", "GiB"},
      {"merge text.vdb -o x.vdb", "text.vdb"},
      {"merge missing.vdb -o x.vdb", "missing.vdb"},
      {"info missing", "missing"},
      {"info text.exr", "text.exr"},
      {"info text.gltf", "text.gltf"},
      {"info folder.vdb", "folder.vdb"},
      {"probe text.vdb --points p.csv -o /dev/null -f", "/dev/null"},
      {"probe text.vdb --points p.csv -o x.csv", "text.vdb"},
      {"probe text.gltf --points p.csv -o x.csv", "text.gltf"},
      {"probe " + scene + " --points missing.csv -o x.csv", "missing.csv"},
      {"probe " + scene + " --points folder.vdb -o x.csv", "folder.vdb"},
  };
  for (const auto& [arguments, text] : cases) expect_refused(folder, arguments + " -q", 1, text);
  EXPECT_EQ(names_in(folder), before);
}

TEST(Cli, OverwritesOnlyWithForce) {
  const auto folder = scratch_folder("force");
  write_file(folder / "x.vdb", "precious");
  expect_refused(folder, small_bake + "-o x.vdb", 1, "--force");
  EXPECT_EQ(read_file(folder / "x.vdb"), "precious");
  EXPECT_EQ(ivory(folder, small_bake + "-o x.vdb --force").exit_code, 0);
  EXPECT_NE(read_file(folder / "x.vdb"), "precious");
  EXPECT_EQ(names_in(folder), std::vector<std::string>{"x.vdb"});
}

TEST(Cli, OutputsThatAreNoFiles) {
  const auto folder = scratch_folder("no_files");
  write_file(folder / "p.csv", "x,y,z,nx,ny,nz\n0,1,0,0,1,0\n");
  const std::string probe = "probe " + scene + " --points p.csv --samples 2 --force -o ";
  expect_refused(folder, probe + "-", 2, "standard output");
  // What /dev/stdout is here: a pipe.
  expect_refused(folder, probe + "/dev/stdout", 1, "/dev/stdout: is a device or a pipe");
  EXPECT_EQ(names_in(folder), std::vector<std::string>{"p.csv"});
  // As long as names may be.
  const std::string name = std::string(245, 'x') + ".csv";
  EXPECT_EQ(ivory(folder, probe + name).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / name));
}

// Closed, or on a full disk: the exit code stays right, and nothing that is printed gets into a file.
TEST(Cli, StreamsThatCannotBeWritten) {
  const auto folder = scratch_folder("streams");
  ASSERT_EQ(ivory(folder, small_bake + "-o whole.vdb").exit_code, 0);
  const std::string whole = read_file(folder / "whole.vdb");
  const auto run = [&](const std::string& arguments) {
    return std::system(("cd '" + folder.string() + "' && '" + ivory_binary + "' " + arguments).c_str()) / 256;
  };
  const std::string bake = "bake grid " + scene + " --resolution 8 --photons 20k -f -o x.vdb ";
  for (const auto& [streams, exit_code] : std::vector<std::pair<std::string, int>>{{"--json >&- 2>&-", 1},
                                                                                   {"--json >/dev/full 2>/dev/full", 1},
                                                                                   {"-q <&- >&- 2>&-", 0},
                                                                                   {"-q 2>/dev/full", 0}}) {
    EXPECT_EQ(run(bake + streams), exit_code) << streams;
    EXPECT_EQ(read_file(folder / "x.vdb"), whole) << streams;
  }
  EXPECT_EQ(run("info missing.vdb 2>&-"), 1);
  EXPECT_EQ(run("info missing.vdb 2>/dev/full"), 1);
  EXPECT_EQ(run("--help >/dev/full 2>/dev/null"), 1);
  EXPECT_EQ(run("info whole.vdb >/dev/full 2>message"), 1);
  EXPECT_TRUE(read_file(folder / "message").starts_with("ivory: standard output: cannot be written (No space left"));
}

TEST(Cli, QuietSaysNothing) {
  const auto folder = scratch_folder("quiet");
  const Outcome outcome = ivory(folder, small_bake + "-o x.vdb");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "");
}

}  // namespace

}  // namespace ivory::script
