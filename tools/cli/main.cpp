// ivory: the command line. Exit codes: 0 done, 1 failed, 2 usage, 130 and 143 stopped by a signal.
#include <csignal>

#include "tools/cli/program.h"
#include "tools/cli/streams.h"

int main(int argc, char** argv) {
  ivory::keep_standard_streams();
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond ulimit -f is an error like others
  const ivory::ProgramEnd end = ivory::run_program(argc, argv);
  if (!end.message.empty()) ivory::print_stderr("ivory: " + end.message + "\n");
  return end.exit_code;
}
