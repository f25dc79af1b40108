// ivory as scripts run it: in a folder of its own, with what it prints and how it ends.
#pragma once

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "tests/support/paths.h"

namespace ivory::script {

namespace fs = std::filesystem;
using Json = nlohmann::json;

inline const std::string scene = std::string(source_folder) + "/scenes/leak_axis.gltf";

inline fs::path scratch_folder(const std::string& name) {
  const fs::path folder = fs::path(output_folder) / ("cli_" + name);
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

inline std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_file(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

struct Outcome {
  int exit_code = -1;  // -1: died by a signal
  std::string out;
  std::string err;
};

// Runs `ivory <arguments>` in `folder`.
inline Outcome ivory(const fs::path& folder, const std::string& arguments) {
  const std::string command = "cd '" + folder.string() + "' && '" + ivory_binary + "' " + arguments + " 2> .stderr";
  FILE* pipe = ::popen(command.c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.out.append(buffer.data(), count);
  const int status = ::pclose(pipe);
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  outcome.err = read_file(folder / ".stderr");
  fs::remove(folder / ".stderr");
  return outcome;
}

// Fails with `exit_code` and one line that holds `text`.
inline void expect_refused(const fs::path& folder, const std::string& arguments, int exit_code,
                           const std::string& text) {
  const Outcome outcome = ivory(folder, arguments);
  EXPECT_EQ(outcome.exit_code, exit_code) << arguments << "\n" << outcome.err;
  EXPECT_NE(outcome.err.find(text), std::string::npos) << arguments << "\n" << outcome.err;
  EXPECT_TRUE(outcome.err.starts_with("ivory: ")) << arguments << "\n" << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << arguments << "\n" << outcome.err;
  EXPECT_EQ(outcome.out, "") << arguments;
}

inline std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

inline const std::string small_bake = "bake grid " + scene + " --resolution 8 --photons 20k -q ";

}  // namespace ivory::script
