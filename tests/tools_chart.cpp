// ivory chart as a script meets it: a tiny curve, measured, gone on with, drawn.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/command_test.h"

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
      GTEST_SKIP() << "no Python with matplotlib";
  }
  void TearDown() override {
    if (!data_.empty()) ::setenv("IVORY_DATA", data_.c_str(), 1);
  }
  // Four points on the bundled sky: a second of work.
  std::string chart(const std::string& more = "") const {
    return "chart sh9 --threads 1 --only 'sh9/sky/sh/*' --only 'sh9/sky/irradiance_map/4' -o " + path("out") + " " +
           more;
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
  std::map<std::string, double> walls_s;
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
      walls_s[record.at("key")] = record.at("wall_s").get<double>();
      continue;
    }
    ++points;
    EXPECT_GE(record.at("nrmse").get<double>(), 0);
    // Of the one timed command, without the program's start.
    EXPECT_EQ(record.at("start_up_s").get<double>(), start_up_s);
    const double wall_s = walls_s.at(record.at("steps").at(0));
    EXPECT_EQ(record.at("time_s").get<double>(), std::max(0.001, wall_s - start_up_s));
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

  // Nothing is measured twice.
  ASSERT_EQ(run_ivory(chart()).exit_code, 0);
  EXPECT_EQ(read("results.jsonl"), log);
  EXPECT_EQ(lines(run_ivory(chart("--list")).output), 4);

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
  EXPECT_NE(part.output.find("left as they were: 4 of 8 points are missing, the first sh9/sky/sh9_window/auto"),
            std::string::npos)
      << part.output;
  EXPECT_EQ(bytes_of(document), old);
  EXPECT_FALSE(fs::exists(path("charts")));

  const RunResult run = run_ivory("chart sh9 --threads 1 -o " + path("out") + " --fill " + document);
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

TEST_F(ChartCommand, BadRequests) {
  expect_one_line("chart", 2, "suite");
  expect_one_line("chart quick", 2, "output");
  expect_one_line("chart nonsense -o " + path("out"), 2, "nonsense");
  expect_one_line("chart quick --size full -o " + path("out"), 2, "--size");
  expect_one_line("chart sh9 --size huge -o " + path("out"), 2, "huge");
  expect_one_line(chart("--fill " + path("missing.md")), 1, "missing.md: no such file");
  expect_one_line("chart sh9 --only nothing_is_called_so -o " + path("out"), 1, "nothing was measured");
}

}  // namespace
}  // namespace ivory
