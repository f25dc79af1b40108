#include "tools/bake/asset_contract.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include "grid/io/file.h"
#include "tools/cli/target_error.h"

namespace ivory {

double peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024 * double(usage.ru_maxrss);
}

std::string irradiance_measure(int normals) {
  return fmt::format("E at {} random normals, unshadowed, against the sum over all of the environment; RMS ÷ mean E",
                     normals);
}

void add_contract_options(Command command, AssetContract& contract, const std::string& error,
                          const std::string& chosen) {
  add_target_error_option(
      command, contract.target,
      error + ":\n" + chosen + "\nMeasured in the end where nothing was chosen by it, and kept in the file");
  command.add_flag("--certify", contract.certify,
                   "Measure that error and keep it in the file, without choosing anything by it");
  add_dry_run_option(command, contract.dry_run);
}

void check_output(const std::string& path, const std::string& extension, const AssetContract& contract,
                  const CommonOptions& common) {
  if (!contract.dry_run) {
    check_output(path, extension, common);
  } else if (lower_extension(path) != extension) {
    throw UsageError(fmt::format("--output: '{}' does not end in {}", path, extension));
  }
}

void print_plan(const std::string& output, const BakePlan& plan, const AssetContract& contract,
                const std::vector<std::string>& warnings, const CommonOptions& common) {
  nlohmann::ordered_json result{{"output", output},
                                {"dry_run", true},
                                {"plan",
                                 {{"knobs", plan.knobs},
                                  {"seconds", prediction_json(plan.seconds)},
                                  {"memory_bytes", prediction_json(plan.memory_bytes)},
                                  {"file_bytes", prediction_json(plan.file_bytes)},
                                  {"error", prediction_json(plan.error)}}}};
  std::string knobs;
  for (const auto& [name, value] : plan.knobs.items()) {
    knobs += fmt::format("{}{} {}", knobs.empty() ? "" : ", ", name,
                         value.is_string() ? value.get<std::string>() : value.dump());
  }
  std::string human = fmt::format("{}: would be baked with {}\n", output, knobs);
  human += fmt::format("time {}, memory {}, file {}\nerror {}", seconds_text(plan.seconds),
                       bytes_text(plan.memory_bytes), bytes_text(plan.file_bytes), share_text(plan.error));
  if (contract.target) {
    const bool met = plan.error.expected <= *contract.target;
    result["plan"]["target"] = *contract.target;
    result["plan"]["meets"] = met;
    human += fmt::format(", {} the asked-for {}", met ? "within" : "more than", format_share(*contract.target));
  }
  result["warnings"] = warnings;
  print_result(common, result, human + "\n");
}

Certificate make_certificate(const MeasuredError& error, const AssetContract& contract, const std::string& measure) {
  return {contract.target.value_or(0), error.error, error.low, error.high, measure, {}};
}

void report_certificate(const Certificate& certificate, nlohmann::ordered_json& result, std::string& human,
                        std::vector<std::string>& warnings, const CommonOptions& common) {
  // Where a result lists the metadata too, its entries would say the same again.
  std::vector<std::string> flat;
  for (const auto& [key, value] : result.items()) {
    if (key.starts_with("certificate_")) flat.push_back(key);
  }
  for (const std::string& key : flat) result.erase(key);
  result["certificate"] = certificate_json(certificate);
  human += certificate_text(certificate);
  const std::string missed = missed_text(certificate);
  if (missed.empty()) return;
  print_warnings(common, {missed});
  warnings.push_back(missed);
}

}  // namespace ivory
