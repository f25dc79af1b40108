// --checkpoint: a long bake is kept beside its output while it is made, and the same command goes on from there.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/cli/common.h"
#include "tracer/bake/checkpoint.h"

namespace ivory {

struct CheckpointOptions {
  double minutes = 5;     // from one to the next; 0: none
  bool is_given = false;  // asked for, not the default
};

void add_checkpoint_option(Command command, CheckpointOptions& options, const std::string& description);
// For bakes that keep none: the option is refused in words, and no part of the help.
void refuse_checkpoint_option(Command command);

// "room.checkpoint.vdb" of "room.vdb".
std::string checkpoint_path(const std::string& output);

// The checkpoint of one bake, from before it to when its output is in place.
class KeptCheckpoint {
 public:
  // `origin`: as CheckpointPolicy has it. `unit`: what is counted.
  KeptCheckpoint(const CheckpointOptions& options, const std::string& output, Metadata origin,
                 const CommonOptions& common, std::string unit = "photons");
  ~KeptCheckpoint();
  KeptCheckpoint(const KeptCheckpoint&) = delete;
  KeptCheckpoint& operator=(const KeptCheckpoint&) = delete;

  // To bake by, within its life: while the bake runs, Ctrl-C and SIGTERM are answered. Lines go to `progress`. Nothing
  // where none is kept.
  std::optional<CheckpointPolicy> policy(Progress& progress);
  // From now on they end the process again.
  void baked();
  // The output is in place: removes the file, and adds to the bake's result what was kept.
  void finish(nlohmann::ordered_json& result);

  std::uint64_t done_before() const { return resumed_.value_or(0); }  // of the unit

 private:
  struct Signals;

  void note(const CheckpointEvent& event, Progress& progress);

  const CommonOptions& common_;
  std::string unit_;
  CheckpointPolicy policy_;
  std::unique_ptr<Signals> signals_;
  std::optional<std::uint64_t> resumed_;
  int written_ = 0;
  double seconds_ = 0;  // that writing them took
  std::vector<std::string> warnings_;
};

}  // namespace ivory
