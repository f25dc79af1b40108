// ivory in the background, to be stopped while it works.
#pragma once

#include <chrono>
#include <csignal>
#include <functional>
#include <string>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

#include "tests/tools/script.h"

namespace ivory::script {

// To be ended at a moment of the test's choice; `ignored` is a signal that its shell ignores.
class BackgroundRun {
 public:
  BackgroundRun(const fs::path& folder, const std::string& arguments, int ignored = 0) : folder_(folder) {
    child_ = ::fork();
    if (child_ != 0) return;
    if (ignored != 0) ::signal(ignored, SIG_IGN);
    const std::string line = "cd '" + folder.string() + "' && exec '" + ivory_binary + "' " + arguments + " 2> .said";
    ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    ::_exit(127);
  }
  bool is_running() {
    if (!is_over_ && ::waitpid(child_, &status_, WNOHANG) == child_) is_over_ = true;
    return !is_over_;
  }
  void signal(int which) const { ::kill(child_, which); }
  // Exit code; less the signal's number where one ended it.
  int end() {
    if (!is_over_) ::waitpid(child_, &status_, 0);
    is_over_ = true;
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_);
  }
  std::string said() const { return read_file(folder_ / ".said"); }

 private:
  fs::path folder_;
  pid_t child_ = -1;
  int status_ = 0;
  bool is_over_ = false;
};

inline void wait_for(BackgroundRun& run, const std::function<bool()>& what) {
  while (run.is_running() && !what()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

// Another file than there was before the run.
inline void wait_for_checkpoint(BackgroundRun& run, const fs::path& checkpoint, fs::file_time_type before) {
  std::error_code gone;  // renamed at this moment
  wait_for(run, [&] { return fs::exists(checkpoint, gone) && fs::last_write_time(checkpoint, gone) != before; });
}

inline fs::file_time_type written(const fs::path& checkpoint) {
  return fs::exists(checkpoint) ? fs::last_write_time(checkpoint) : fs::file_time_type::min();
}

}  // namespace ivory::script
