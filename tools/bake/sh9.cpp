// ivory bake sh9: an environment map's irradiance as nine spherical-harmonic coefficients.
#include "grid/io/sh9.h"

#include <chrono>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/env/irradiance.h"
#include "grid/env/irradiance/error.h"
#include "grid/io/export/sh9_dialect.h"
#include "tools/bake/asset_contract.h"
#include "tools/bake/checkpoint.h"
#include "tools/bake/facts.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/environment.h"

namespace ivory {

namespace {

// Random normals that order and window are chosen at, and others that the result is judged at.
constexpr int pilot_normals = 400;
constexpr int certificate_normals = 500;
constexpr std::uint64_t pilot_seed = 1;
constexpr std::uint64_t certificate_seed = 2;

struct BakeSh9Options {
  EnvironmentChoice environment;
  std::string output;
  std::string order = "auto";
  double max_error = 0.01;
  std::string window = "none";
  Sh9Dialect dialect = Sh9Dialect::ivory;
  AssetContract contract;
};

struct Sh9Choice {
  int order = 2;
  std::string window = "none";
  MeasuredError predicted;
};

// The lowest order up to `most` that meets the error, with that of `windows` which leaves the least; where none does,
// the best of all. Each choice depends on `target` by comparison alone, so that a tighter one never gives less.
Sh9Choice choose_order(const Sh9& whole, const IrradianceTruth& pilot, double target, int most,
                       const std::vector<std::string>& windows) {
  Sh9Choice best;
  bool first = true;
  for (int order = 0; order <= most; ++order) {
    for (const std::string& window : windows) {
      const Sh9 sh = truncated(whole, order);
      const MeasuredError error = sh9_rms_error(windowed(sh, chosen_window(window, sh)), pilot);
      if (first || error.high < best.predicted.high) best = {order, window, error};
      first = false;
    }
    if (best.predicted.high <= target) break;
  }
  return best;
}

BakePlan make_plan(const Sh9Choice& choice, const IrradianceTree& tree) {
  const auto start = std::chrono::steady_clock::now();
  make_irradiance_truth(tree, pilot_normals, pilot_seed);
  const double each =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / double(pilot_normals);
  BakePlan plan;
  plan.knobs["order"] = choice.order;
  plan.knobs["window"] = choice.window;
  plan.seconds = within_factor(each * (cube_faces * sh9_truth_size * sh9_truth_size + certificate_normals), 2);
  plan.memory_bytes = within_factor(peak_memory_bytes(), 1.3);
  plan.file_bytes = within_factor(4000, 2);
  plan.error = predicted_error(choice.predicted);
  return plan;
}

void run_bake_sh9(const BakeSh9Options& options, const Command& command, const CommonOptions& common) {
  const AssetContract& contract = options.contract;
  const bool automatic = options.order == "auto";
  const bool max_error_given = command.get_option("--max-error").given();
  if (!automatic && max_error_given) throw UsageError("--max-error serves --order auto only");
  if (contract.target && max_error_given)
    throw UsageError("--max-error and --target-error both choose the order: give one of them");
  chosen_window(options.window, Sh9{});
  check_output(options.output, ".json", contract, common);
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  EnvironmentInput input = load_environment_input(options.environment, common);
  const auto loaded = Clock::now();
  print_warnings(common, input.warnings);
  const RadianceMoments moments = radiance_moments(input.image);
  const Sh9 whole = sh9_from_moments(moments);
  const auto projected = Clock::now();
  const IrradianceTree tree = make_irradiance_tree(input.image);
  Sh9Choice choice;
  if (contract.target) {
    const std::vector<std::string> windows = command.get_option("--window").given()
                                                 ? std::vector<std::string>{options.window}
                                                 : std::vector<std::string>{"none", "auto"};
    choice = choose_order(whole, make_irradiance_truth(tree, pilot_normals, pilot_seed), *contract.target,
                          automatic ? 2 : std::stoi(options.order), windows);
    if (contract.dry_run) {
      print_plan(options.output, make_plan(choice, tree), contract, input.warnings, common);
      return;
    }
  }
  const IrradianceMap truth = bake_irradiance(tree, sh9_truth_size);

  Sh9Asset asset;
  if (contract.target) {
    asset = make_sh9_asset(whole, {choice.order, 0, choice.window}, truth.e, moments.total, std::move(input.origin));
  } else {
    const std::optional<int> order = automatic ? std::nullopt : std::optional(std::stoi(options.order));
    asset = make_sh9_asset(whole, {order, options.max_error, options.window}, truth.e, moments.total,
                           std::move(input.origin));
    choice = {asset.order, options.window, {}};
  }
  if (contract.dry_run) {
    choice.predicted = sh9_rms_error(asset.sh, make_irradiance_truth(tree, pilot_normals, pilot_seed));
    print_plan(options.output, make_plan(choice, tree), contract, input.warnings, common);
    return;
  }
  std::optional<Certificate> certificate;
  if (contract.measures()) {
    certificate = make_certificate(
        sh9_rms_error(asset.sh, sum_irradiance_truth(input.image, certificate_normals, certificate_seed)), contract,
        irradiance_measure(certificate_normals));
    keep_certificate(*certificate, asset.metadata);
  }
  const V3d least = minimum_irradiance(asset.sh);
  const double least_e = std::min({least.x, least.y, least.z});
  write_sh9_dialect(options.output, asset, options.dialect, common.force);

  nlohmann::ordered_json result{{"file", options.output},
                                {"kind", "sh9"},
                                {"dialect", name_of(options.dialect)},
                                {"layout", name_of(input.image.layout)},
                                {"order", asset.order},
                                {"window", {1, asset.window.band1, asset.window.band2}},
                                {"average_error", asset.error.average},
                                {"maximum_error", asset.error.maximum},
                                {"average_error_of_mean_irradiance", asset.error.average_of_mean_e()},
                                {"maximum_error_of_mean_irradiance", asset.error.maximum_of_mean_e()},
                                {"total_radiance", {moments.total.x, moments.total.y, moments.total.z}},
                                {"least_irradiance_lux", least_e},
                                {"read_seconds", std::chrono::duration<double>(loaded - start).count()},
                                {"projection_seconds", std::chrono::duration<double>(projected - loaded).count()}};
  std::string text = fmt::format(
      "{}: order {}, {} coefficients a channel{}\n", options.output, asset.order, (asset.order + 1) * (asset.order + 1),
      asset.window.band1 != 1 || asset.window.band2 != 1
          ? fmt::format(", bands 1 and 2 times {:.3f} and {:.3f}", asset.window.band1, asset.window.band2)
          : std::string());
  text += fmt::format(
      "error of E: {:.2f} % on average, {:.2f} % at most, of the light of the whole sphere ({:.1f} % and {:.1f} % of "
      "the "
      "mean E)\n",
      100 * asset.error.average, 100 * asset.error.maximum, 100 * asset.error.average_of_mean_e(),
      100 * asset.error.maximum_of_mean_e());
  if (contract.target) {
    if (certificate->error > *contract.target && asset.order == 2)
      text += "nine coefficients are not enough, 'ivory bake difmap' keeps it all\n";
  } else if (automatic && asset.order < 2) {
    text += fmt::format("order {} already meets --max-error {:g}\n", asset.order, options.max_error);
  } else if (automatic && asset.error.average > options.max_error) {
    text +=
        fmt::format("more than --max-error {:g}: nine coefficients are not enough, 'ivory bake difmap' keeps it all\n",
                    options.max_error);
  }
  if (certificate) report_certificate(*certificate, result, text, input.warnings, common);
  result["warnings"] = input.warnings;
  result["enough"] =
      contract.target ? certificate->error <= *contract.target : asset.error.average <= options.max_error;
  if (least_e < 0 && choice.window == "none")
    text += "the polynomial falls below zero for some normals (read as zero); --window auto smooths that away\n";
  print_result(common, result, text);
}

}  // namespace

void add_bake_sh9_command(Command bake, CommonOptions& common) {
  Command command = bake.add_subcommand("sh9", "Nine spherical-harmonic coefficients of an environment map (.json)");
  auto options = std::make_shared<BakeSh9Options>();
  command.add_option("environment", options->environment.path, "Environment map in nits: .exr, .hdr or other image")
      .required()
      .type_name("ENV");
  command.add_option("-o,--output", options->output, "Coefficients to write, .json").required().type_name("OUT.json");
  add_layout_option(command, options->environment);
  command.add_option("--order", options->order, "Highest band; auto stores the lowest that meets --max-error")
      .one_of({"auto", "0", "1", "2"});
  command
      .add_option("--max-error", options->max_error,
                  "For --order auto: average error of E, as a fraction of the light of the whole sphere")
      .within(0.0, 1.0);
  command
      .add_option("--window", options->window,
                  "Against negative lobes: none, auto (the least change that keeps E from falling below zero), or the\n"
                  "width of a Hann window in bands, from 2")
      .type_name("none|auto|WIDTH");
  add_contract_options(
      command, options->contract, "Error of E to be reached, RMS over normals ÷ mean E, as 2% or 0.02",
      "the lowest order that does is stored, at most --order, with the better window of none and auto unless\n"
      "--window says which");
  command.add_choice("--dialect", options->dialect, "Who is to read it; only ivory's own is read back");
  command.footer(
      "E(n) = (n 1) M (n 1)^T in lux, with the file's matrices M for R, G and B.\n"
      "--json: read_seconds is the time to load the map, projection_seconds that of its nine coefficients; the rest "
      "of\n"
      "the command's time goes into measuring their error at 6144 normals.\n"
      "\nExamples:\n"
      "  ivory bake sh9 sky.exr -o sky.json\n"
      "  ivory bake sh9 probe.hdr -o probe.json --layout angular --order 2 --window auto --dialect three.js");
  refuse_checkpoint_option(command);
  set_action(command, common, Output::file, [options, command, &common] { run_bake_sh9(*options, command, common); });
}

}  // namespace ivory
