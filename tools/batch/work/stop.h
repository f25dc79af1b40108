// Ctrl-C and SIGTERM in a batch: bakes that keep checkpoints write theirs, then the process leaves.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "tools/cli/host.h"
#include "tools/cli/interrupt.h"

namespace ivory {

// Thread-safe. While it stands, the signals are its own.
class BatchStop {
 public:
  // `last_words`: what the process says where it has to leave at once.
  explicit BatchStop(const std::string& last_words);

  // How asset `asset`, which is being made, can be stopped.
  void set(int asset, Stoppable state);
  void ended(int asset) { set(asset, Stoppable::no); }
  // Has a signal come? Who asks leaves what can be stopped the time to save.
  bool asked() const { return interrupt_.asked(); }
  bool any(Stoppable state) const;

 private:
  bool is_any(Stoppable state) const;  // with the lock

  mutable std::mutex mutex_;
  std::map<int, Stoppable> states_;
  Interrupt interrupt_;
};

}  // namespace ivory
