// What `ivory batch` says: a line an asset, for people or in JSON.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tools/batch/work/run.h"

namespace ivory {

// --list
std::string list_line(const Job& job, int asset, bool json);

// --dry-run; `prediction`: of the bake ("seconds", "memory_bytes" ...), or null.
std::string plan_line(const Job& job, int asset, const AssetPlan& plan, const nlohmann::ordered_json& prediction,
                      bool json);

// --explain: all that is known of why.
std::string explanation(const Job& job, int asset, const AssetPlan& plan, const AssetRecord* record, bool json);

// Of an asset that has ended.
std::string outcome_line(const Job& job, int asset, const AssetOutcome& outcome, bool json);

// "3 baked, 17 fresh, 1 failed, 2 skipped in 4:10".
std::string summary(const std::vector<AssetPlan>& plans, const std::vector<AssetOutcome>& outcomes, double seconds);

}  // namespace ivory
