// Command lines, a word a line. They are read, found right or wrong, and carried out as far as that goes without files:
// in a folder that has been removed, which nothing can be read from or written to. Commands that need no file (charts,
// benchmarks, windows) are left out.
#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include <unistd.h>

#include "tests/fuzz/support.h"
#include "tools/cli/program.h"

namespace {

using namespace ivory;

// Names the process' own files by no path.
bool leaves_folder(const std::string& word) { return word.find('/') != std::string::npos; }

void enter_removed_folder() {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(fuzz::file_of(nullptr, 0, ".txt")).parent_path() / "removed";
  fs::create_directory(folder);
  fs::current_path(folder);
  fs::remove(folder);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool prepared = [] {
    enter_removed_folder();
    std::cout.rdbuf(nullptr);  // help pages; failing to print them is one of the ends
    return true;
  }();
  fuzz::require(prepared, "the folder");

  std::istringstream lines(std::string(reinterpret_cast<const char*>(data), size));
  std::vector<std::string> words{"ivory"};
  for (std::string word; words.size() < 40 && std::getline(lines, word);) words.push_back(word);
  if (std::any_of(words.begin(), words.end(), leaves_folder)) return 0;
  const auto given = [&](const char* command) { return std::find(words.begin(), words.end(), command) != words.end(); };
  if (given("chart") || given("bench") || given("view")) return 0;

  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const ProgramEnd end = run_program(int(words.size()), arguments.data());
  fuzz::require(end.exit_code >= 0 && end.exit_code <= 2, "the exit code");
  fuzz::require(end.message.empty() == (end.exit_code == 0), "a message, if and only if something is wrong");
  fuzz::require(end.message.find('\n') == std::string::npos, "more than a line");
  fuzz::require(end.exit_code != 0 || given("--help") || given("-h") || given("--version"), "work done without a file");
  return 0;
}
