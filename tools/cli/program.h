// The program without its main(): from a command line to an exit code.
#pragma once

#include <string>
#include <vector>

namespace ivory {

class CommandHost;

struct ProgramEnd {
  int exit_code = 0;    // 0 done, 1 failed, 2 usage
  std::string message;  // for stderr, one line without its end; empty where all went well
};

// Does what the command line says, and prints what its command prints, but for the error that it ends with. argv[0] is
// the program's own name.
ProgramEnd run_program(int argc, char** argv);

// The same for a command that another one runs: {"bake", "grid", "room.glb", ...}. What it prints goes to `host`, whose
// `stage` says how far it is taken. Several threads may run commands at a time.
ProgramEnd run_hosted(const std::vector<std::string>& arguments, CommandHost& host);

// An option or argument of a command, as the command declares it.
struct OptionFacts {
  std::string name;  // "target-error" of --target-error; "scene" of an argument that goes by its place
  bool by_place = false;
  bool flag = false;
  bool repeated = false;  // may have several values
  bool required = false;
  std::string type_name;              // "METRES"
  std::vector<std::string> choices;   // its values, where it has a fixed set
  std::vector<std::string> excludes;  // names of options that do not go with it
  std::string description;
};

// All but the common ones (--threads, --json, --quiet, --force, --help). `command` is its path, {"bake", "grid"}, and
// there is one.
std::vector<OptionFacts> options_of(const std::vector<std::string>& command);

}  // namespace ivory
