// Makes what of a job is to be made: in order, side by side, each from inputs that are loaded once.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/batch/work/board.h"
#include "tools/batch/work/log.h"
#include "tools/batch/work/plan.h"
#include "tools/cli/common.h"

namespace ivory {

struct RunSettings {
  int side_by_side = 0;     // assets at a time; 0: 2, and one more for every 8 threads
  double memory_bytes = 0;  // that they may take together; 0: three quarters of what there is
  std::string record;       // file
};

enum class AssetState { baked, fresh, failed, skipped };
template <>
inline constexpr auto name_table<AssetState> = make_name_table<AssetState>("state of an asset",
                                                                           {{AssetState::baked, "baked"},
                                                                            {AssetState::fresh, "fresh"},
                                                                            {AssetState::failed, "failed"},
                                                                            {AssetState::skipped, "skipped"}});

struct AssetOutcome {
  AssetState state = AssetState::skipped;
  double seconds = 0;
  std::vector<std::string> reasons;   // why it was baked
  std::vector<std::string> warnings;  // of its command
  std::string error;                  // why it failed or was skipped
};

// Called as assets end, one at a time; answers what is to stand on standard output, a line without its end, or nothing.
using OutcomeListener = std::function<std::string(int asset, const AssetOutcome& outcome)>;

// Assets that are chosen in `plans`. `record` is kept up to date on disk, so that a batch that is killed goes on where
// it was. A failing asset stops those that need it.
std::vector<AssetOutcome> run_assets(const Job& job, const std::vector<AssetPlan>& plans, BatchRecord& record,
                                     Sources& sources, const RunSettings& settings, const CommonOptions& common,
                                     BatchLog& log, const OutcomeListener& ended);

}  // namespace ivory
