// An asset that many tests read: baked by the first of them, also where each runs in a process of its own.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include "tests/support/paths.h"
#include "tests/support/run_ivory.h"

namespace ivory {

// The path of the file `name`, made by `ivory <arguments> -o <path>`: again where the arguments have changed, or the
// program or one of the bundled scenes since.
inline std::string baked_once(const std::string& name, const std::string& arguments) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(output_folder) / "baked_once";
  fs::create_directories(folder);
  const std::string path = (folder / name).string();
  const std::string note = path + ".arguments";
  const int lock = ::open((path + ".lock").c_str(), O_RDWR | O_CREAT, 0644);
  EXPECT_EQ(::flock(lock, LOCK_EX), 0) << path;
  const auto is_fresh = [&] {
    std::ifstream file(note);
    if (!fs::exists(path) || std::string(std::istreambuf_iterator<char>(file), {}) != arguments) return false;
    const auto made = fs::last_write_time(path);
    if (made <= fs::last_write_time(ivory_binary)) return false;
    for (const auto& entry : fs::directory_iterator(fs::path(source_folder) / "scenes")) {
      if (made <= entry.last_write_time()) return false;
    }
    return true;
  };
  if (!is_fresh()) {
    const RunResult bake = run_ivory(arguments + " --force -o " + path);
    EXPECT_EQ(bake.exit_code, 0) << bake.output;
    std::ofstream(note) << arguments;
  }
  ::close(lock);
  return path;
}

}  // namespace ivory
