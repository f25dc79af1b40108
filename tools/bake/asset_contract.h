// An error that is asked for, the plan to reach it, and the certificate of what was reached: what the bakes of all
// assets but grids have in common.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "grid/base/certificate.h"
#include "grid/base/measured_error.h"
#include "grid/base/prediction.h"
#include "tools/cli/common.h"

namespace ivory {

struct AssetContract {
  std::optional<double> target;  // share
  bool certify = false;
  bool dry_run = false;

  // Is the error to be measured and kept? Without, bakes are what they are by their other options, to the byte.
  bool measures() const { return target.has_value() || certify; }
};

// --target-error, --certify and --dry-run. `error` says what the error is: "error of E, RMS over normals ÷ mean E".
// `chosen` names what is chosen to meet it, and by which options it is bounded.
void add_contract_options(Command command, AssetContract& contract, const std::string& error,
                          const std::string& chosen);

// check_output(), which a dry run leaves out but for the extension: it needs no place to write to.
void check_output(const std::string& path, const std::string& extension, const AssetContract& contract,
                  const CommonOptions& common);

// The error that was measured on a pilot.
inline Prediction predicted_error(const MeasuredError& error) { return {error.low, error.error, error.high}; }

// What this process has used at most so far.
double peak_memory_bytes();

// NOLINTNEXTLINE(bugprone-exception-escape): moving a JSON value does not throw, whatever its checks of itself may do.
struct BakePlan {
  nlohmann::ordered_json knobs;  // by their options' names: {"size": 64}
  Prediction seconds;            // of what is still to be done, certificate included
  Prediction memory_bytes;       // of the process at its peak
  Prediction file_bytes;
  Prediction error;
};

// The result of a dry run: "plan" with knobs, seconds, memory_bytes, file_bytes and error, the last four with low,
// expected and high, and with --target-error whether the prediction meets it.
void print_plan(const std::string& output, const BakePlan& plan, const AssetContract& contract,
                const std::vector<std::string>& warnings, const CommonOptions& common);

// The certificate of `error`, `measure` saying over what and against what.
Certificate make_certificate(const MeasuredError& error, const AssetContract& contract, const std::string& measure);

// The measure of assets that hold an environment's irradiance at `normals` normals.
std::string irradiance_measure(int normals);

// Says the certificate in the result: "certificate" and, where it misses its target, a warning, which is also printed;
// `human` gets its lines. To be called when `warnings` have been printed and before they stand in the result.
void report_certificate(const Certificate& certificate, nlohmann::ordered_json& result, std::string& human,
                        std::vector<std::string>& warnings, const CommonOptions& common);

}  // namespace ivory
