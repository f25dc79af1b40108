// What tests of the command line share: a folder of their own, and ivory run as a script runs it.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/folder_test.h"
#include "tests/support/paths.h"
#include "tests/support/run_ivory.h"

namespace ivory {

inline std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class CommandTest : public FolderTest {
 protected:
  static std::string scene(const std::string& name) { return std::string(source_folder) + "/scenes/" + name; }

  // The result object of a command that must end well.
  static nlohmann::json run(const std::string& arguments) {
    const RunResult result = run_ivory(arguments + " --json", false);
    EXPECT_EQ(result.exit_code, 0) << arguments << "\n" << run_ivory(arguments).output;
    return nlohmann::json::parse(result.output, nullptr, false);
  }
  static void expect_one_line(const std::string& arguments, int exit_code, const std::string& text) {
    const RunResult result = run_ivory(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.output;
    EXPECT_EQ(std::count(result.output.begin(), result.output.end(), '\n'), 1) << arguments << "\n" << result.output;
    EXPECT_NE(result.output.find(text), std::string::npos) << arguments << "\n" << result.output;
  }
};

}  // namespace ivory
