// ivory bake lobes: the table of lobe products, and how good it is.
#include "grid/io/lobes.h"

#include <chrono>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"

namespace ivory {

namespace {

struct BakeLobesOptions {
  std::string output;
  LobeTableParams table;
  int samples = 100'000;
  std::uint64_t seed = 1;
};

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

void store(Metadata& m, const std::string& name, const Distribution& d) {
  m[name + "_mean"] = d.mean;
  m[name + "_median"] = d.median;
  m[name + "_worst"] = d.worst;
}

void run(const BakeLobesOptions& options, const CommonOptions& common) {
  check_output(options.output, ".exr", common);
  const auto seconds_since = [](std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const auto start = std::chrono::steady_clock::now();
  const LobeTable table = make_lobe_table(options.table);
  const double build_seconds = seconds_since(start);
  const LobeTableErrors errors = lobe_table_errors(table, options.samples, options.seed);

  Metadata m;
  m["version"] = std::string(IVORY_VERSION);
  m["method"] = std::string("moments");
  m["error_samples"] = std::int64_t(errors.samples);
  m["error_seed"] = std::int64_t(options.seed);
  store(m, "integral_error", errors.absolute);
  store(m, "integral_error_relative", errors.of_true);
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
  command.add_count("--error-samples", options->samples, 1, 100'000'000,
                    "Random products that the errors are measured on");
  command.add_count("--seed", options->seed, "Seed of those");
  command.footer(
      "A product's integral and vector moment are exact but for the table's interpolation; its shape is that of the\n"
      "one lobe that has them. The table depends on no scene.\n"
      "\nExample:\n"
      "  ivory bake lobes -o lobes.exr");
  set_action(command, common, Output::file, [options, &common] { run(*options, common); });
}

}  // namespace ivory
