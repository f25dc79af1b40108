// What of a job is to be made, found before anything is.
#pragma once

#include <string>
#include <vector>

#include "tools/batch/job/job.h"
#include "tools/batch/state/record.h"
#include "tools/batch/state/sources.h"

namespace ivory {

struct AssetPlan {
  bool chosen = false;               // by --only, or needed by what is; what follows is of these alone
  bool stale = false;                // is to be made, or may be: it needs one that is
  std::vector<std::string> reasons;  // why
  std::string error;                 // what keeps it from being made; empty: nothing that is known
};

// Assets in an order in which each comes after what it needs.
std::vector<int> in_order(const Job& job);

// `only`: patterns over names of assets ("grid.*", or without their kind); empty: all. Throws UsageError for a pattern
// that matches none.
std::vector<bool> choose_assets(const Job& job, const std::vector<std::string>& only);

// Does the pattern match its name, with or without its kind?
bool is_named(const JobAsset& asset, const std::string& pattern);

// [asset]. `force`: what is there and no batch has written may be overwritten.
std::vector<AssetPlan> plan_assets(const Job& job, const std::vector<bool>& chosen, const BatchRecord& record,
                                   Sources& sources, bool force);

// The record of an asset, or nullptr.
const AssetRecord* find_record(const BatchRecord& record, const std::string& asset);

}  // namespace ivory
