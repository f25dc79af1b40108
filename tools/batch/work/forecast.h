// What the assets of a plan would take, as the bakes themselves foretell it.
#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/batch/work/plan.h"
#include "tools/cli/common.h"

namespace ivory {

// [asset]: "seconds" and "memory_bytes", each with "expected" and, where a bake foretells them, "low" and "high";
// "from" says how it is known: "last bake" or "dry run". Null for what is fresh, and for what only a bake can tell:
// because its kind foretells nothing, or it needs an asset that is not there yet. Bakes that an earlier run has not
// timed are asked by their own --dry-run, which may make pilots.
std::vector<nlohmann::ordered_json> forecast(const Job& job, const std::vector<AssetPlan>& plans,
                                             const BatchRecord& record, const CommonOptions& common);

}  // namespace ivory
