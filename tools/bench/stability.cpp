// ivory bench stability: the stability suite's points, beside what they are held to.
#include "tools/stability/stability.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"

namespace ivory {
namespace {

struct BenchStabilityOptions {
  std::vector<std::string> names;
  bool quick = false;
  bool list = false;
};

// NaN is beyond every bound.
bool is_held(const StabilityPoint& p) { return !p.bound || p.error <= *p.bound; }

nlohmann::ordered_json to_json(const StabilityCase& c, const StabilityPoint& p) {
  return {{"case", c.name},         {"title", c.title},
          {"sentence", c.sentence}, {"x", p.x},
          {"x_label", c.x_label},   {"series", p.series},
          {"error", p.error},       {"bound", p.bound ? nlohmann::ordered_json(*p.bound) : nullptr},
          {"y_label", c.y_label},   {"log_x", c.log_x},
          {"log_y", c.log_y}};
}

std::string to_text(const StabilityCase& c, const std::vector<StabilityPoint>& points) {
  std::size_t width = 6;
  for (const StabilityPoint& p : points) width = std::max(width, p.series.size());
  std::string text = fmt::format("{}: {}\n  {}\n  x: {}; error: {}\n  {:<{}}  {:>9}  {:>9}  {:>9}\n", c.name, c.title,
                                 c.sentence, c.x_label, c.y_label, "series", width, "x", "error", "bound");
  for (const StabilityPoint& p : points) {
    text += fmt::format("  {:<{}}  {:>9.3g}  {:>9.3g}  {:>9}{}\n", p.series, width, p.x, p.error,
                        p.bound ? fmt::format("{:.3g}", *p.bound) : "-", is_held(p) ? "" : "  BROKEN");
  }
  return text;
}

void run(const BenchStabilityOptions& options, const CommonOptions& common) {
  std::vector<StabilityCase> cases;
  for (const std::string& name : options.names) cases.push_back(stability_case(name));
  if (cases.empty()) cases = stability_cases();
  if (options.list) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    std::string text;
    for (const StabilityCase& c : cases) {
      list.push_back({{"case", c.name}, {"title", c.title}});
      text += fmt::format("{:<20} {}\n", c.name, c.title);
    }
    print_result(common, {{"cases", list}}, text);
    return;
  }
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  std::string text;
  std::string broken;
  {
    Progress progress(common, "sweeping", "cases");
    std::uint64_t done = 0;
    for (const StabilityCase& c : cases) {
      progress.update(done++, cases.size());
      const std::vector<StabilityPoint> points = c.run({.quick = options.quick});
      for (const StabilityPoint& p : points) all.push_back(to_json(c, p));
      text += fmt::format("{}{}", text.empty() ? "" : "\n", to_text(c, points));
      const auto beyond = std::count_if(points.begin(), points.end(), [](const auto& p) { return !is_held(p); });
      if (beyond > 0)
        broken += fmt::format("{}{} ({} of {} points)", broken.empty() ? "" : ", ", c.name, beyond, points.size());
    }
  }
  print_result(common, {{"points", all}}, text);
  if (!broken.empty()) {
    throw Error("stability of " + broken, "errors beyond their bounds",
                "compare with an unchanged build; where that breaks too, the bounds are wrong");
  }
}

}  // namespace

void add_bench_stability_command(Command bench, CommonOptions& common) {
  Command command = bench.add_subcommand(
      "stability",
      "Sweeps through every place where a method fails, and fails itself where an error is beyond its bound. With\n"
      "--json an object of `points`, each with case, title, sentence, x, x_label, series, error, bound (null where a\n"
      "series only shows the failure), y_label, log_x, log_y.");
  auto options = std::make_shared<BenchStabilityOptions>();
  command.add_option("CASE", options->names, "Cases to run; all by default");
  command.add_flag("--quick", options->quick, "Fewer samples: what the tests run");
  command.add_flag("--list", options->list, "Names and titles of the cases");
  command.footer("Example:\n  ivory bench stability wall_angle --quick");
  set_action(command, common, Output::none, [options, &common] { run(*options, common); });
}

}  // namespace ivory
