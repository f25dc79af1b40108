// ivory chart as a script meets it: a tiny curve, measured, gone on with, drawn.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/command_test.h"
#include "tests/support/paths.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

class ChartCommand : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    // Bundled inputs alone: the same points with and without sample data at hand.
    const char* data = std::getenv("IVORY_DATA");
    data_ = data != nullptr ? data : "";
    ::unsetenv("IVORY_DATA");
    if (run_ivory("chart sh9 --list --only none -o " + path("probe")).output.find("finds no Python") !=
        std::string::npos)
      GTEST_SKIP() << "no Python with matplotlib and jinja2";
  }
  void TearDown() override {
    if (!data_.empty()) ::setenv("IVORY_DATA", data_.c_str(), 1);
  }
  // Four points on the bundled sky: a second of work.
  std::string chart(const std::string& more = "") const {
    return "chart sh9 --size rough --threads 1 --only 'sh9/sky/sh/*' --only 'sh9/sky/irradiance_map/4' -o " +
           path("out") + " " + more;
  }
  std::string read(const std::string& name) const { return bytes_of(path("out/" + name)); }

 private:
  std::string data_;
};

int lines(const std::string& text) { return int(std::count(text.begin(), text.end(), '\n')); }

TEST_F(ChartCommand, MeasuresGoesOnAndDraws) {
  const RunResult first = run_ivory(chart());
  ASSERT_EQ(first.exit_code, 0) << first.output;
  const std::string log = read("results.jsonl");
  int points = 0;
  double start_up_s = 0;
  std::map<std::string, nlohmann::json> results;
  std::size_t begin = 0;
  for (std::size_t end = log.find('\n'); end != std::string::npos; begin = end + 1, end = log.find('\n', begin)) {
    const auto record = nlohmann::json::parse(log.substr(begin, end - begin));
    for (const char* field : {"key", "kind", "version", "build", "machine"})
      EXPECT_TRUE(record.contains(field)) << field;
    if (record.at("kind") == "start_up") {
      start_up_s = record.at("wall_s").get<double>();
      EXPECT_GE(record.at("walls_s").size(), 7U);
      continue;
    }
    if (record.at("kind") == "step") {
      for (const char* field : {"command", "seed", "wall_s", "walls_s", "peak_memory_bytes", "foreign", "result"})
        EXPECT_TRUE(record.contains(field)) << field;
      EXPECT_GT(record.at("peak_memory_bytes").get<double>(), 1e6);
      results[record.at("key")] = record.at("result");
      continue;
    }
    ++points;
    EXPECT_GE(record.at("nrmse").get<double>(), 0);
    EXPECT_EQ(record.at("start_up_s").get<double>(), start_up_s);
    // As the bake itself says, without what it spends on measuring its own error.
    const auto& bake = results.at(record.at("steps").at(0));
    const char* baking = bake.contains("projection_seconds") ? "projection_seconds" : "bake_seconds";
    EXPECT_DOUBLE_EQ(record.at("time_s").get<double>(),
                     bake.at("read_seconds").get<double>() + bake.at(baking).get<double>());
    // Order 0 is a constant: the bundled sky is far from that; nine coefficients hold it to 4 %.
    if (record.at("label") == "order 0") {
      EXPECT_GT(record.at("nrmse").get<double>(), 0.2);
    } else if (record.at("label") == "order 2") {
      EXPECT_LT(record.at("nrmse").get<double>(), 0.05);
    }
  }
  EXPECT_EQ(points, 4);
  for (const char* name : {"sh9_order.svg", "sh9_order.png", "sh9.html"}) EXPECT_GT(read(name).size(), 1000U) << name;
  const std::string page = read("sh9.html");
  EXPECT_NE(page.find("src=\"data:image/svg+xml;base64,"), std::string::npos);
  EXPECT_EQ(page.find("src=\"sh9"), std::string::npos) << "the page must hold its pictures";

  // That nothing is measured twice is InputsAreFollowed's.
  const std::string listed = run_ivory(chart("--list")).output;
  EXPECT_EQ(lines(listed), 4);
  EXPECT_EQ(listed.find("      "), std::string::npos) << "not done:\n" << listed;

  // A run that was cut short in the middle of a line, its files gone, ends in the same results.
  const std::size_t cut = log.rfind('\n', log.size() - 2) + 20;
  fs::resize_file(path("out/results.jsonl"), cut);
  fs::remove_all(path("out/work"));
  ASSERT_EQ(run_ivory(chart()).exit_code, 0);
  const auto last = [](const std::string& text) {
    return nlohmann::json::parse(text.substr(text.rfind('\n', text.size() - 2) + 1));
  };
  EXPECT_EQ(last(read("results.jsonl")).at("nrmse"), last(log).at("nrmse"));
  EXPECT_EQ(last(read("results.jsonl")).at("key"), last(log).at("key"));
}

TEST_F(ChartCommand, FillsTablesOfADocument) {
  const std::string document = path("accuracy.md");
  std::ofstream(document) << "# Accuracy\n\n<!-- chart: sh9 -->\nold\n<!-- /chart -->\nKept.\n<!-- chart: none "
                             "-->\nstays\n<!-- /chart -->\n![SH9](charts/sh9_order.png)\n";
  const std::string old = bytes_of(document);
  // Four points are not the whole curve: no table of them gets into a document.
  const RunResult part = run_ivory(chart("--fill " + document));
  ASSERT_EQ(part.exit_code, 0) << part.output;
  EXPECT_NE(part.output.find("left as they were: 1 of 5 points are missing, the first sh9/sky/sh9_window/auto"),
            std::string::npos)
      << part.output;
  EXPECT_EQ(bytes_of(document), old);
  EXPECT_FALSE(fs::exists(path("charts")));

  const RunResult run = run_ivory("chart sh9 --size rough --threads 1 -o " + path("out") + " --fill " + document);
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_NE(run.output.find("have no none"), std::string::npos) << run.output;
  const std::string text = bytes_of(document);
  EXPECT_EQ(text.find("old"), std::string::npos);
  EXPECT_NE(text.find("| sky |"), std::string::npos) << text;
  EXPECT_NE(text.find("Kept."), std::string::npos);
  EXPECT_NE(text.find("stays"), std::string::npos);
  EXPECT_TRUE(bytes_of(path("charts/sh9_order.png")) == read("sh9_order.png"));  // no dump of a picture
  EXPECT_FALSE(read("sh9_order.png").empty());
}

// Records of a kind in a results.jsonl, by one of their fields.
std::map<std::string, nlohmann::json> records_of(const std::string& log, const std::string& kind,
                                                 const std::string& field) {
  std::map<std::string, nlohmann::json> found;
  std::istringstream stream(log);
  for (std::string line; std::getline(stream, line);) {
    const auto record = nlohmann::json::parse(line);
    if (record.at("kind") == kind) found[record.at(field)] = record;
  }
  return found;
}

std::map<std::string, nlohmann::json> points_of(const std::string& log) { return records_of(log, "point", "name"); }

// One point of each curve but sh9, which the other tests measure, in a folder whose name a shell and a URI would each
// misread.
TEST_F(ChartCommand, EachCurveMeasures) {
  const std::string folder = path("a b%41");
  std::string only;
  for (const char* name : {"bases/1_distant_light/vectors/0", "fiv/one_hard_light_floating/six_hemispheres/16_9_8",
                           "cubemap/coloured_box/convolved/2", "lobes/one_ball_of_light/lobes_and_gaussians/all",
                           "rates/sh9/bench/all", "stability/grid_planes"})
    only += std::string(" --only ") + name;
  const std::string arguments = "chart quick --threads 2 -o '" + folder + "'" + only;
  const RunResult listed = run_ivory(arguments + " --list", false);
  EXPECT_EQ(listed.exit_code, 0);
  EXPECT_FALSE(fs::exists(folder)) << "--list writes";
  ASSERT_EQ(lines(listed.output), 6) << listed.output;

  const auto result = run(arguments);
  EXPECT_EQ(result.at("points"), lines(listed.output));
  EXPECT_EQ(result.at("failed"), 0);
  EXPECT_GE(result.at("charts").get<int>(), 5);
  EXPECT_EQ(result.at("page"), folder + "/index.html");
  EXPECT_GT(bytes_of(folder + "/index.html").size(), 10000U);
  const auto points = points_of(bytes_of(folder + "/results.jsonl"));
  for (const auto& [name, point] : points)
    EXPECT_NE(listed.output.find("      " + name + "\n"), std::string::npos) << name;
  EXPECT_EQ(int(points.size()), lines(listed.output));
  EXPECT_TRUE(points.at("stability/grid_planes").at("within_bounds"));
  // The time of a whole command is without the program's start.
  run("chart grid --size rough --threads 2 -o '" + folder + "' --only grid/cornell_box/path_tracing/1");
  const std::string log = bytes_of(folder + "/results.jsonl");
  const nlohmann::json path_traced = points_of(log).at("grid/cornell_box/path_tracing/1");
  const auto step = records_of(log, "step", "key").at(path_traced.at("steps").at(0));
  EXPECT_DOUBLE_EQ(path_traced.at("time_s").get<double>(),
                   std::max(0.001, step.at("wall_s").get<double>() - path_traced.at("start_up_s").get<double>()));
  // Commands can be pasted into a shell.
  const std::string command = points.at("bases/1_distant_light/vectors/0").at("commands").at(0);
  EXPECT_EQ(std::system((command + " > '" + path("pasted") + "' 2>&1").c_str()), 0)
      << command << bytes_of(path("pasted"));
}

TEST_F(ChartCommand, GuardsItsResults) {
  const std::string one = "chart sh9 --size rough --threads 1 -o " + path("out") + " --only sh9/sky/sh/order_0";
  ASSERT_EQ(run_ivory(one).exit_code, 0);
  const std::string log = read("results.jsonl");

  // A line damaged for good is told and left out; what it held is measured again.
  const std::size_t first = log.find('\n') + 1;
  std::ofstream(path("out/results.jsonl")) << "{\"key\": \"1" << log;
  const RunResult damaged = run_ivory(one);
  EXPECT_EQ(damaged.exit_code, 0) << damaged.output;
  EXPECT_NE(damaged.output.find("1 damaged line left out"), std::string::npos) << damaged.output;
  std::ofstream(path("out/results.jsonl")) << log.substr(0, first) << "nonsense\n" << log.substr(first) << "{\"ke";
  // Who only reads leaves the end alone, which another run may be writing.
  EXPECT_NE(run_ivory(one + " --list").output.find("done  sh9/sky/sh/order_0"), std::string::npos);
  EXPECT_EQ(run_ivory(one + " --draw").exit_code, 0);
  EXPECT_TRUE(read("results.jsonl").ends_with("\n{\"ke"));
  EXPECT_EQ(run_ivory(one).exit_code, 0);
  EXPECT_TRUE(read("results.jsonl").ends_with(log.substr(first))) << "measured again";

  // A disk that is full in the middle of a record, by a limit of 512-byte blocks.
  const std::string whole = read("results.jsonl");
  const std::string limited = "ulimit -f " + std::to_string(whole.size() / 512 + 1) + "; exec " + ivory_binary +
                              " chart sh9 --size rough --threads 1 --quiet -o " + path("out") +
                              " --only sh9/sky/sh/order_1 > " + path("said") + " 2>&1";
  EXPECT_EQ(WEXITSTATUS(std::system(limited.c_str())), 1);
  EXPECT_NE(bytes_of(path("said")).find("results.jsonl: cannot be written"), std::string::npos)
      << bytes_of(path("said"));
  EXPECT_TRUE(read("results.jsonl") == whole);

  const int held = ::open(path("out/lock").c_str(), O_RDWR);
  ASSERT_EQ(::flock(held, LOCK_EX), 0);
  expect_one_line(one, 1, "another ivory chart is measuring");
  EXPECT_EQ(run_ivory(one + " --list").exit_code, 0);
  ::close(held);
  expect_one_line("chart sh9 -o " + path("said"), 1, "is no folder");
  expect_one_line("chart sh9 -o " + path("said/below"), 1, "cannot be made");
}

TEST_F(ChartCommand, InputsAreFollowed) {
  fs::create_directories(path("data/env"));
  const std::string map = path("data/env/noon_grass_1k.hdr");
  fs::copy_file(scene("sky.hdr"), map);
  ::setenv("IVORY_DATA", path("data").c_str(), 1);
  const std::string one =
      "chart sh9 --size rough --quiet --threads 1 -o " + path("out") + " --only sh9/noon_grass/sh/order_0";
  ASSERT_EQ(run_ivory(one).exit_code, 0);
  const std::string log = read("results.jsonl");
  // A generated file that is damaged, or left of other sources, is made again, and means nothing new.
  const std::string normals = read("scenes/normals_60.csv");
  std::ofstream(path("out/scenes/normals_60.csv")) << normals.substr(0, normals.size() / 2);
  ASSERT_EQ(run_ivory(one).exit_code, 0);
  EXPECT_TRUE(read("scenes/normals_60.csv") == normals);
  EXPECT_EQ(read("results.jsonl"), log);

  std::fstream(map, std::ios::in | std::ios::out | std::ios::binary).seekp(-4, std::ios::end) << "\x80\x01\x80\x81";
  ASSERT_EQ(run_ivory(one).exit_code, 0);
  const std::string more = read("results.jsonl");
  ASSERT_TRUE(more.starts_with(log));
  EXPECT_EQ(points_of(more.substr(log.size())).count("sh9/noon_grass/sh/order_0"), 1U);
}

// A shell script that starts a point of many seconds as `ivory`, with SIGINT ignored as of what a script starts in the
// background, does something once its first command runs, and prints its exit code.
std::string script(const std::string& ivory, const std::string& folder, const std::string& then) {
  return "(trap '' INT; exec " + ivory + " chart grid --threads 1 --only grid/cornell_box/path_tracing/1 -o " + folder +
         ") > " + folder + ".said 2>&1 & run=$!; n=0; until grep -q '^.1/1' " + folder +
         ".said || [ $n -ge 1200 ]; do sleep 0.1; n=$((n+1)); done; sleep 0.3; child=$(cat "
         "/proc/$run/task/$run/children); " +
         then + "; wait $run; echo $?; kill -0 $child 2>/dev/null && echo left";
}

std::string shell(const std::string& words) {
  FILE* pipe = popen(words.c_str(), "r");
  std::array<char, 256> buffer{};
  const std::size_t n = fread(buffer.data(), 1, buffer.size() - 1, pipe);
  pclose(pipe);
  return {buffer.data(), n};
}

TEST_F(ChartCommand, EndsWithItsCommand) {
  EXPECT_EQ(shell(script(ivory_binary, path("out"), "kill -TERM $run")), "1\n");
  EXPECT_NE(bytes_of(path("out.said")).find("ivory: interrupted"), std::string::npos) << bytes_of(path("out.said"));

  // A build that changes under it.
  fs::copy_file(ivory_binary, path("ivory"));
  EXPECT_EQ(shell(script(path("ivory"), path("other"), "touch " + path("ivory"))), "1\n");
  EXPECT_NE(bytes_of(path("other.said")).find("was built anew"), std::string::npos) << bytes_of(path("other.said"));
}

TEST_F(ChartCommand, BadRequests) {
  expect_one_line("chart", 2, "suite");
  expect_one_line("chart quick", 2, "output");
  expect_one_line("chart nonsense -o " + path("out"), 2, "nonsense");
  expect_one_line("chart quick --size full -o " + path("out"), 2, "--size");
  expect_one_line("chart fiv --size rough -o " + path("out"), 2, "rough is of grid and sh9");
  expect_one_line("chart sh9 --size huge -o " + path("out"), 2, "huge");
  expect_one_line(chart("--fill " + path("missing.md")), 1, "missing.md: no such file");
  expect_one_line("chart sh9 --only nothing_is_called_so -o " + path("out"), 1, "nothing was measured");
}

}  // namespace
}  // namespace ivory
