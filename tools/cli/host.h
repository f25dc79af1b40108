// Commands that another command runs in its own process, as `ivory batch` does: what they print goes to their host, and
// what they read they share.
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tools/cli/common.h"

namespace ivory {

class SharedInputs;  // tools/input/shared.h

// How far a command line is taken: read and found right; its options checked against each other, up to where the first
// input is read or work begins; or all the way.
enum class CommandStage { parse, check, run };

// May a command be stopped now: not without losing what it has done; whenever it asks next; once it has saved what it
// is just saving.
enum class Stoppable { no, yes, saving };

class CommandHost {
 public:
  explicit CommandHost(CommandStage stage_to) : stage(stage_to) {}
  virtual ~CommandHost() = default;
  CommandHost(const CommandHost&) = delete;
  CommandHost& operator=(const CommandHost&) = delete;

  // What print_result(), print_note() and Progress are given, from the command's own thread but for progress(), which
  // any thread may call.
  virtual void result(const nlohmann::ordered_json& object, const std::string& human) = 0;
  virtual void note(const std::string& line) = 0;
  virtual void progress(const std::string& label, const std::string& unit, std::uint64_t done, std::uint64_t total) = 0;

  // Work that can be stopped and gone on from says so while it is at it, and asks from any thread whether it shall
  // stop.
  virtual void set_stoppable(Stoppable /*state*/) {}
  virtual bool stop_asked() const { return false; }

  CommandStage stage;
  SharedInputs* inputs = nullptr;  // null: the command loads its own
};

// Thrown by begin_work(); ends a command of stage `check` well.
struct WorkBegins {};

// Commands call it, by way of what loads scenes and environments and of Progress, before what takes time. Throws
// WorkBegins in stage `check`.
inline void begin_work(const CommonOptions& common) {
  if (common.host != nullptr && common.host->stage == CommandStage::check) throw WorkBegins();
}

}  // namespace ivory
