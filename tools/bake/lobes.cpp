// ivory bake lobes: the table of lobe products, and how good it is.
#include "grid/io/lobes.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "tools/bake/asset_contract.h"
#include "tools/bake/checkpoint.h"
#include "tools/bake/facts.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"

namespace ivory {

namespace {

struct BakeLobesOptions {
  std::string output;
  LobeTableParams table;
  int samples = 100'000;
  std::uint64_t seed = 1;
  AssetContract contract;
};

constexpr LobeTableParams largest_table{129, 513};
// Random products that the table is chosen by, and others that it is judged by.
constexpr std::uint64_t pilot_pairs = 3000;
constexpr std::uint64_t certificate_pairs = 10'000;
constexpr std::uint64_t pilot_seed = 0x70696c6f74;
constexpr std::uint64_t certificate_seed = 0x63657274;

struct Choice {
  LobeTableParams table;
  MeasuredError predicted;
};

// The smallest table that meets the error: of all sizes on a ladder of both numbers of nodes, in the order of memory,
// the first that does, or where none does the one whose interval ends lowest. By comparison with `target` alone, so
// that a tighter one never gives a smaller table.
Choice choose_table(const std::vector<LobePair>& pilot, double target, const LobeTableParams& most) {
  std::vector<LobeTableParams> sizes;
  for (const int exponents : {3, 5, 7, 9, 13, 17, 25, 33, 49, 65, 97, 129}) {
    for (const int angles : {5, 9, 13, 17, 25, 33, 49, 65, 97, 129, 193, 257, 385, 513}) {
      // Beyond this one of the two is wasted on the other's error.
      if (exponents <= most.exponent_nodes && angles <= most.angle_nodes && angles >= exponents &&
          angles <= 8 * exponents)
        sizes.push_back({exponents, angles});
    }
  }
  sizes.push_back(most);
  std::stable_sort(sizes.begin(), sizes.end(), [](const LobeTableParams& a, const LobeTableParams& b) {
    return lobe_table_bytes(a) < lobe_table_bytes(b);
  });
  Choice best;
  bool first = true;
  for (const LobeTableParams& size : sizes) {
    const MeasuredError error = lobe_integral_error(make_lobe_table_for(size, pilot), pilot);
    const bool met = error.high <= target;
    if (first || met || error.high < best.predicted.high) best = {size, error};
    first = false;
    if (met) break;
  }
  return best;
}

BakePlan make_plan(const Choice& choice, double seconds_a_node, int samples) {
  BakePlan plan;
  plan.knobs["exponent-nodes"] = choice.table.exponent_nodes;
  plan.knobs["angle-nodes"] = choice.table.angle_nodes;
  const auto bytes = double(lobe_table_bytes(choice.table));
  const double nodes = bytes / (LobeTable::channels * sizeof(float));
  // A sample of the errors takes about five times as long as a node.
  plan.seconds = within_factor(seconds_a_node * (nodes + 5.0 * samples + double(certificate_pairs)), 2.5);
  plan.memory_bytes = within_factor(peak_memory_bytes() + 3 * bytes, 1.5);
  plan.file_bytes = {0.5 * bytes, 0.85 * bytes, bytes + 4096};
  plan.error = predicted_error(choice.predicted);
  return plan;
}

using Distribution = LobeTableErrors::Distribution;

nlohmann::ordered_json json_of(const Distribution& d) {
  return {{"mean", d.mean},
          {"median", d.median},
          {"worst", d.worst},
          {"worst_at", {{"e1", d.worst_e1}, {"e2", d.worst_e2}, {"angle_deg", d.worst_angle_rad * 180 / double(pi)}}}};
}

std::string line_of(const char* what, const Distribution& d) {
  return fmt::format("{:<34} mean {:.2e}  median {:.2e}  worst {:.2e} at e {:.4g}, {:.4g}, {:.1f} deg\n", what, d.mean,
                     d.median, d.worst, d.worst_e1, d.worst_e2, d.worst_angle_rad * 180 / double(pi));
}

void run(const BakeLobesOptions& options, const Command& command, const CommonOptions& common) {
  const AssetContract& contract = options.contract;
  check_output(options.output, ".exr", contract, common);
  const auto seconds_since = [](std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const auto start = std::chrono::steady_clock::now();
  LobeTableParams size = options.table;
  if (contract.target || contract.dry_run) {
    const std::vector<LobePair> pilot = make_lobe_pairs(pilot_pairs, pilot_seed);
    const double seconds_a_node = seconds_since(start) / double(pilot_pairs);
    Choice choice{size, {}};
    if (contract.target) {
      LobeTableParams most = largest_table;
      if (command.get_option("--exponent-nodes").given()) most.exponent_nodes = size.exponent_nodes;
      if (command.get_option("--angle-nodes").given()) most.angle_nodes = size.angle_nodes;
      choice = choose_table(pilot, *contract.target, most);
    } else {
      choice.predicted = lobe_integral_error(make_lobe_table_for(size, pilot), pilot);
    }
    size = choice.table;
    if (contract.dry_run) {
      print_plan(options.output, make_plan(choice, seconds_a_node, options.samples), contract, {}, common);
      return;
    }
  }
  const LobeTable table = make_lobe_table(size);
  const double build_seconds = seconds_since(start);
  const LobeTableErrors errors = lobe_table_errors(table, options.samples, options.seed);

  Metadata m = lobe_facts(errors, options.seed);
  std::optional<Certificate> certificate;
  if (contract.measures()) {
    const std::vector<LobePair> pairs = make_lobe_pairs(certificate_pairs, certificate_seed);
    certificate = make_certificate(lobe_integral_error(table, pairs), contract,
                                   fmt::format("integrals of {} random products of two lobes against the exact ones; "
                                               "mean relative error",
                                               pairs.size()));
    keep_certificate(*certificate, m);
  }
  write_lobes(options.output, table, m, common.force);

  nlohmann::ordered_json result;
  result["output"] = options.output;
  result["exponent_nodes"] = table.exponent_nodes;
  result["angle_nodes"] = table.angle_nodes;
  result["largest_exponent"] = max_lobe_exponent;
  result["bytes"] = table.bytes();
  result["build_seconds"] = build_seconds;
  result["error_samples"] = errors.samples;
  result["integral_error"] = json_of(errors.absolute);
  result["integral_error_of_largest"] = json_of(errors.of_largest);
  result["integral_error_relative"] = json_of(errors.of_true);
  result["exponent_error"] = json_of(errors.exponent);
  result["axis_error_widths"] = json_of(errors.axis);
  result["shape_error"] = json_of(errors.shape);
  std::string human = fmt::format("{}: {} x {} exponents to {:.0f}, {} angles, {}, {:.2f} s\n", options.output,
                                  table.exponent_nodes, table.exponent_nodes, max_lobe_exponent, table.angle_nodes,
                                  format_bytes(table.bytes()), build_seconds);
  human += fmt::format("{} random products against their exact moments:\n", format_count(double(errors.samples)));
  human += line_of("integral, absolute", errors.absolute);
  human += line_of("integral / that at angle 0", errors.of_largest);
  human += "of those above 1e-6 of the integral at angle 0:\n";
  human += line_of("integral, relative", errors.of_true);
  human += line_of("exponent + 1, relative", errors.exponent);
  human += line_of("axis, in lobe widths", errors.axis);
  human += line_of("shape, L2 relative", errors.shape);
  human += "caps need no table: exponent 2c/(1 - c), scale 1 + c, c the cosine of the half-angle\n";
  if (certificate) {
    std::vector<std::string> warnings;
    report_certificate(*certificate, result, human, warnings, common);
    result["warnings"] = warnings;
  }
  print_result(common, result, human);
}

}  // namespace

void add_bake_lobes_command(Command bake, CommonOptions& common) {
  Command command = bake.add_subcommand("lobes", "The table of products of cosine lobes, for render --method lobes");
  auto options = std::make_shared<BakeLobesOptions>();
  command.add_option("-o,--output", options->output, "Table to write").required().type_name("OUT.exr");
  command.add_option("--exponent-nodes", options->table.exponent_nodes, "Nodes along each exponent, from 0 to 100000")
      .within(2, 129);
  command.add_option("--angle-nodes", options->table.angle_nodes, "Nodes along the angle between the axes")
      .within(2, 513);
  add_contract_options(
      command, options->contract, "Mean relative error of products' integrals to be reached, as 2% or 0.02",
      "the smallest table that does is built, of at most --exponent-nodes and --angle-nodes where these are given");
  command.add_count("--error-samples", options->samples, 1, 100'000'000,
                    "Random products that the errors are measured on");
  command.add_count("--seed", options->seed, "Seed of those");
  command.footer(
      "A product's integral and vector moment are exact but for the table's interpolation; its shape is that of the\n"
      "one lobe that has them. The table depends on no scene.\n"
      "\nExample:\n"
      "  ivory bake lobes -o lobes.exr");
  refuse_checkpoint_option(command);
  set_action(command, common, Output::file, [options, command, &common] { run(*options, command, common); });
}

}  // namespace ivory
