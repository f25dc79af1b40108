// ivory bench stability: the stability suite's points, as lines of JSON.
#include "tools/stability/stability.h"

#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/common.h"

namespace ivory {
namespace {

struct BenchStabilityOptions {
  std::vector<std::string> names;
  bool quick = false;
  bool list = false;
};

void print_points(const StabilityCase& c, const StabilityParams& params) {
  for (const StabilityPoint& point : c.run(params)) {
    const nlohmann::ordered_json line{
        {"case", c.name},         {"title", c.title},
        {"sentence", c.sentence}, {"x", point.x},
        {"x_label", c.x_label},   {"series", point.series},
        {"error", point.error},   {"bound", point.bound ? nlohmann::ordered_json(*point.bound) : nullptr},
        {"y_label", c.y_label},   {"log_x", c.log_x},
        {"log_y", c.log_y}};
    fmt::print("{}\n", line.dump());
  }
  std::fflush(stdout);  // whoever reads along draws case by case
}

void run(const BenchStabilityOptions& options, const CommonOptions& common) {
  std::vector<StabilityCase> cases;
  for (const std::string& name : options.names) cases.push_back(stability_case(name));
  if (cases.empty()) cases = stability_cases();
  if (options.list) {
    for (const StabilityCase& c : cases) fmt::print("{:<20} {}\n", c.name, c.title);
    return;
  }
  Progress progress(common, "sweeping", "cases");
  std::uint64_t done = 0;
  for (const StabilityCase& c : cases) {
    progress.update(done++, cases.size());
    print_points(c, {.quick = options.quick});
  }
}

}  // namespace

void add_bench_stability_command(CLI::App& bench, CommonOptions& common) {
  CLI::App* command = bench.add_subcommand(
      "stability",
      "Sweeps through every place where a method fails. One line of JSON a point: case, title, sentence, x, x_label,\n"
      "series, error, bound (null where a series only shows the failure), y_label, log_x, log_y.");
  auto options = std::make_shared<BenchStabilityOptions>();
  command->add_option("CASE", options->names, "Cases to run; all by default");
  command->add_flag("--quick", options->quick, "Fewer samples: what the tests run");
  command->add_flag("--list", options->list, "Names and titles of the cases");
  command->footer("Example:\n  ivory bench stability wall_angle --quick");
  set_action(*command, common, Output::none, [options, &common] { run(*options, common); });
}

}  // namespace ivory
