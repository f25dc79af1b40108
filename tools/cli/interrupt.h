// Ctrl-C and SIGTERM while there is something to save: who works is asked to leave, and leaves in any case.
#pragma once

#include <string>

namespace ivory {

// While it stands, SIGINT and SIGTERM do not end the process; one at a time, in one thread. A signal that was ignored
// when the program began, as shells do for jobs in the background and SIGINT, stays so.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // Has such a signal come? Who asks is then trusted to leave soon. Where nobody asks for 1.8 seconds after it, or it
  // comes a second time, the process ends at once: with exit code 128 and the signal's number, and, but for the second
  // time, the line that was set last. Any thread.
  bool asked() const;
  void set_last_words(const std::string& line);  // without its end
  // While `is` nobody can ask, and it is waited for: something is being saved already.
  void be_patient(bool is);
};

// 130 after SIGINT, 143 after SIGTERM, 1 where neither came.
int interrupted_exit_code();

}  // namespace ivory
