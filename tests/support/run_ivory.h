// Runs the ivory binary as a shell would.
#pragma once

#include <array>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include <sys/wait.h>

#include "tests/support/paths.h"

namespace ivory {

struct RunResult {
  int exit_code = -1;  // -1: ended by a signal
  std::string output;  // stdout, or stdout and stderr
};

// `arguments` are the shell's, and `environment` what it sets before the program, as in "HOME=/ LANG=C"; stderr is kept
// too where `with_errors`.
inline RunResult run_ivory(const std::string& arguments, bool with_errors = true, const std::string& environment = {}) {
  RunResult result;
  const std::string command =
      environment + " " + ivory_binary + " " + arguments + (with_errors ? " 2>&1" : " 2>/dev/null");
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return result;
  std::array<char, 4096> buffer;
  for (std::size_t n = 0; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    result.output.append(buffer.data(), n);
  const int status = pclose(pipe);
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  return result;
}

// What the help page lists as commands below its own: "grid" of `ivory bake --help`.
inline std::vector<std::string> listed_commands(const std::string& page) {
  std::vector<std::string> commands;
  const std::size_t list = page.find("Subcommands:\n");
  if (list == std::string::npos) return commands;
  std::istringstream lines(page.substr(list));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && line.starts_with("  ")) {
    if (line[2] != ' ') commands.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  return commands;
}

}  // namespace ivory
