// Other engines' own code, where it is at hand: node and npm packages in the folder that the environment variable
// IVORY_NODE_MODULES names. CONTRIBUTING.md says which.
#pragma once

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "tests/support/paths.h"

namespace ivory {

inline bool has_node_packages() { return std::getenv("IVORY_NODE_MODULES") != nullptr; }

// What tests/readers/SCRIPT prints, given those arguments.
inline nlohmann::json run_reader(const std::string& script, const std::string& arguments) {
  const std::string command =
      std::string("node ") + source_folder + "/tests/readers/" + script + " " + arguments + " 2>&1";
  std::string output;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {};
  std::array<char, 4096> buffer;
  for (std::size_t n = 0; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) output.append(buffer.data(), n);
  EXPECT_EQ(pclose(pipe), 0) << command << "\n" << output;
  return nlohmann::json::parse(output, nullptr, false);
}

}  // namespace ivory

#define SKIP_WITHOUT_NODE_PACKAGES() \
  if (!has_node_packages()) GTEST_SKIP() << "IVORY_NODE_MODULES names no folder of npm packages (CONTRIBUTING.md)"
