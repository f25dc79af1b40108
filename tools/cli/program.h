// The program without its main(): from a command line to an exit code.
#pragma once

#include <string>

namespace ivory {

struct ProgramEnd {
  int exit_code = 0;    // 0 done, 1 failed, 2 usage
  std::string message;  // for stderr, one line without its end; empty where all went well
};

// Does what the command line says, and prints what its command prints, but for the error that it ends with. argv[0] is
// the program's own name.
ProgramEnd run_program(int argc, char** argv);

}  // namespace ivory
