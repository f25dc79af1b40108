#include "tools/batch/work/plan.h"

#include <functional>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/batch/job/each.h"
#include "tools/batch/state/freshness.h"
#include "tools/cli/usage_error.h"

namespace ivory {

std::vector<int> in_order(const Job& job) {
  std::vector<int> order;
  std::vector<bool> placed(job.assets.size(), false);
  const std::function<void(int)> place = [&](int index) {
    if (placed[std::size_t(index)]) return;
    placed[std::size_t(index)] = true;
    for (const int need : job.assets[std::size_t(index)].needs) place(need);
    order.push_back(index);
  };
  for (std::size_t i = 0; i < job.assets.size(); ++i) place(int(i));
  return order;
}

bool is_named(const JobAsset& asset, const std::string& pattern) {
  return matches(pattern, asset.name) || matches(pattern, asset.name.substr(asset.kind->name.size() + 1));
}

std::vector<bool> choose_assets(const Job& job, const std::vector<std::string>& only) {
  std::vector<bool> chosen(job.assets.size(), only.empty());
  for (const std::string& pattern : only) {
    bool any = false;
    for (std::size_t i = 0; i < job.assets.size(); ++i) {
      const JobAsset& asset = job.assets[i];
      if (!is_named(asset, pattern)) continue;
      chosen[i] = true;
      any = true;
    }
    std::vector<std::string> names;
    for (const JobAsset& asset : job.assets) names.push_back(asset.name);
    if (!any)
      throw UsageError(
          fmt::format("{} has no asset '{}'{}; --list names them", job.file, pattern, like(pattern, names)));
  }
  // And what they need, by what comes before.
  const std::vector<int> order = in_order(job);
  for (auto index = order.rbegin(); index != order.rend(); ++index) {
    if (!chosen[std::size_t(*index)]) continue;
    for (const int need : job.assets[std::size_t(*index)].needs) chosen[std::size_t(need)] = true;
  }
  return chosen;
}

const AssetRecord* find_record(const BatchRecord& record, const std::string& asset) {
  const auto found = record.assets.find(asset);
  return found == record.assets.end() ? nullptr : &found->second;
}

std::vector<AssetPlan> plan_assets(const Job& job, const std::vector<bool>& chosen, const BatchRecord& record,
                                   Sources& sources, bool force) {
  std::vector<AssetPlan> plans(job.assets.size());
  std::vector<bool> stale(job.assets.size(), false);
  for (const int index : in_order(job)) {
    const JobAsset& asset = job.assets[std::size_t(index)];
    AssetPlan& plan = plans[std::size_t(index)];
    plan.chosen = chosen[std::size_t(index)];
    if (!plan.chosen) continue;
    const AssetRecord* known = find_record(record, asset.name);
    try {
      plan.reasons = reasons_to_bake(asset, inputs_of(asset, sources, stale), known, sources);
      if (!force) check_ownership(asset, known, sources);
    } catch (const std::exception& error) {
      plan.error = error.what();
    }
    for (const int need : asset.needs) {
      if (stale[std::size_t(need)])
        plan.reasons.push_back(fmt::format("it needs {}, which is baked", job.assets[std::size_t(need)].name));
    }
    plan.stale = !plan.reasons.empty() || !plan.error.empty();
    stale[std::size_t(index)] = plan.stale;
  }
  return plans;
}

}  // namespace ivory
