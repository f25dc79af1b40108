#include "tools/batch/report.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace ivory {

namespace {

using Json = nlohmann::ordered_json;

// Names in files need not be UTF-8.
std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::vector<std::string> names_of_needs(const Job& job, const JobAsset& asset) {
  std::vector<std::string> names;
  for (const int need : asset.needs) names.push_back(job.assets[std::size_t(need)].name);
  return names;
}

Json begin(const JobAsset& asset) {
  return {{"asset", asset.name}, {"kind", asset.kind->name}, {"outputs", asset.outputs}};
}

// "about 12 s (8 to 20)".
std::string range_text(const Json& range, const std::function<std::string(double)>& text) {
  if (range.contains("low"))
    return fmt::format("about {} ({} to {})", text(range["expected"].get<double>()), text(range["low"].get<double>()),
                       text(range["high"].get<double>()));
  return "about " + text(range["expected"].get<double>());
}

}  // namespace

std::string list_line(const Job& job, int index, bool json) {
  const JobAsset& asset = job.assets[std::size_t(index)];
  const std::vector<std::string> needs = names_of_needs(job, asset);
  if (json) {
    Json line = begin(asset);
    line["needs"] = needs;
    line["command"] = arguments_of(asset);
    return dump(line);
  }
  std::string text = fmt::format("{}: {}", asset.name, fmt::join(asset.outputs, ", "));
  if (!needs.empty()) text += fmt::format(", needs {}", fmt::join(needs, ", "));
  return text;
}

std::string plan_line(const Job& job, int index, const AssetPlan& plan, const Json& prediction, bool json) {
  const JobAsset& asset = job.assets[std::size_t(index)];
  const char* const state = !plan.error.empty() ? "failed" : plan.stale ? "stale" : "fresh";
  if (json) {
    Json line = begin(asset);
    line["state"] = state;
    line["reasons"] = plan.reasons;
    if (!plan.error.empty()) line["error"] = plan.error;
    if (prediction.is_object()) line.update(prediction);
    return dump(line);
  }
  if (!plan.error.empty()) return fmt::format("{}: would fail: {}", asset.name, plan.error);
  if (!plan.stale) return asset.name + ": fresh";
  std::string text = fmt::format("{}: would be baked: {}", asset.name, fmt::join(plan.reasons, "; "));
  if (!prediction.is_object()) return text;
  const auto seconds = [](double s) { return s < 100 ? fmt::format("{:.2g} s", s) : format_duration(s); };
  const auto bytes = [](double b) { return format_bytes(std::uint64_t(b)); };
  if (prediction.contains("seconds")) text += "; time " + range_text(prediction["seconds"], seconds);
  if (prediction.contains("memory_bytes")) text += "; memory " + range_text(prediction["memory_bytes"], bytes);
  return text;
}

std::string explanation(const Job& job, int index, const AssetPlan& plan, const AssetRecord* record, bool json) {
  const JobAsset& asset = job.assets[std::size_t(index)];
  if (json) {
    Json line = begin(asset);
    line["state"] = plan.stale ? "stale" : "fresh";
    line["reasons"] = plan.reasons;
    if (!plan.error.empty()) line["error"] = plan.error;
    return dump(line);
  }
  std::string text = asset.name + (plan.stale ? " would be baked:" : " is fresh");
  for (const std::string& reason : plan.reasons) text += "\n  " + reason;
  if (!plan.error.empty()) text += "\n  it would fail: " + plan.error;
  if (plan.stale || record == nullptr) return text;
  text += "; it depends on";
  for (const auto& [name, value] : record->inputs.entries) {
    const auto parts = record->inputs.parts.find(name);
    text += "\n  " + name;
    if (parts != record->inputs.parts.end()) text += fmt::format(", {} parts", parts->second.size());
    if (name.starts_with("option ") || name.starts_with("baking version")) text += ": " + value;
  }
  return text;
}

std::string outcome_line(const Job& job, int index, const AssetOutcome& outcome, bool json) {
  const JobAsset& asset = job.assets[std::size_t(index)];
  if (json) {
    Json line = begin(asset);
    line["state"] = name_of(outcome.state);
    line["seconds"] = outcome.seconds;
    line["reasons"] = outcome.reasons;
    line["warnings"] = outcome.warnings;
    if (!outcome.error.empty()) line["error"] = outcome.error;
    return dump(line);
  }
  switch (outcome.state) {
    case AssetState::baked:
      return fmt::format("{}: baked in {:.2f} s: {}", asset.name, outcome.seconds, fmt::join(outcome.reasons, "; "));
    case AssetState::fresh:
      return asset.name + ": fresh";
    case AssetState::failed:
      return fmt::format("{}: failed: {}", asset.name, outcome.error);
    case AssetState::skipped:
      return fmt::format("{}: skipped: {}", asset.name, outcome.error);
  }
  return {};
}

std::string summary(const std::vector<AssetPlan>& plans, const std::vector<AssetOutcome>& outcomes, double seconds) {
  std::map<AssetState, int> counts;
  for (std::size_t i = 0; i < plans.size(); ++i) {
    if (plans[i].chosen) ++counts[outcomes[i].state];
  }
  std::string text;
  for (const auto& [state, count] : counts)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name_of(state));
  return text + (seconds < 100 ? fmt::format(" in {:.2f} s", seconds) : " in " + format_duration(seconds));
}

}  // namespace ivory
