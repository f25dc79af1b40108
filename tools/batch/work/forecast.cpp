#include "tools/batch/work/forecast.h"

#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/cli/host.h"
#include "tools/cli/program.h"
#include "tools/input/shared.h"

namespace ivory {

namespace {

using Json = nlohmann::ordered_json;

// Keeps the plan of a command's --dry-run.
class PlanHost : public CommandHost {
 public:
  PlanHost() : CommandHost(CommandStage::run) {}
  void result(const Json& object, const std::string&) override {
    if (object.contains("plan")) plan = object["plan"];
  }
  void note(const std::string&) override {}
  void progress(const std::string&, const std::string&, std::uint64_t, std::uint64_t) override {}

  Json plan;
};

bool are_there(const JobAsset& asset) {
  for (const JobInput& input : asset.inputs) {
    std::error_code error;
    if (!std::filesystem::exists(input.path, error)) return false;
  }
  return true;
}

Json from_dry_run(const JobAsset& asset, SharedInputs& shared, const CommonOptions& common) {
  PlanHost host;
  host.inputs = &shared;
  std::vector<std::string> arguments = arguments_of(asset);
  arguments.insert(arguments.end(), {"--dry-run", "--force"});
  if (common.threads > 0) arguments.push_back(fmt::format("--threads={}", common.threads));
  if (run_hosted(arguments, host).exit_code != 0 || !host.plan.is_object()) return nullptr;
  Json json;
  for (const char* key : {"seconds", "memory_bytes"}) {
    if (host.plan.contains(key)) json[key] = host.plan[key];
  }
  json["from"] = "dry run";
  return json;
}

}  // namespace

std::vector<Json> forecast(const Job& job, const std::vector<AssetPlan>& plans, const BatchRecord& record,
                           const CommonOptions& common) {
  std::vector<Json> forecasts(job.assets.size());
  SharedInputs shared;
  Progress progress(common, "asking", "bakes");
  for (std::size_t i = 0; i < job.assets.size(); ++i) {
    const JobAsset& asset = job.assets[i];
    progress.update(i, job.assets.size());
    if (!plans[i].stale || !plans[i].error.empty()) continue;
    const AssetRecord* known = find_record(record, asset.name);
    if (known != nullptr && known->finished) {
      forecasts[i]["seconds"] = {{"expected", known->seconds}};
      if (known->memory_bytes > 0) forecasts[i]["memory_bytes"] = {{"expected", known->memory_bytes}};
      forecasts[i]["from"] = "last bake";
    } else if (asset.kind->predicts && are_there(asset)) {
      forecasts[i] = from_dry_run(asset, shared, common);
    }
  }
  return forecasts;
}

}  // namespace ivory
