// Work in a process of its own, for parsers that may crash on what they read.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace ivory {

struct TrialOutcome {
  enum class Kind { returned, threw, crashed, not_started };
  Kind kind = Kind::crashed;
  std::string text;  // what the action returned, or what() of the std::exception it threw
};

// Runs `action` in a forked child and waits for it. A child that takes more than `memory_bytes` on top
// of what this process has, or that runs for more than ten minutes, counts as crashed.
TrialOutcome run_trial(std::uint64_t memory_bytes, const std::function<std::string()>& action);

// A file without a name that holds `bytes`, in memory, for parsers that want a path.
class MemoryFile {
 public:
  // Throws std::bad_alloc where memory does not suffice.
  explicit MemoryFile(const std::string& bytes);
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const;

 private:
  int descriptor_;
};

}  // namespace ivory
