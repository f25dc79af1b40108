// ivory bench all: every inner loop beside its bound, and the machine that it ran on.
#include "tools/bench/all.h"

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/bench/machine.h"
#include "tools/bench/rows.h"
#include "tools/cli/common.h"

namespace ivory {
namespace {

struct BenchAllOptions {
  int rounds = 5;
  double scale = 1;
  std::string only;
};

void run(const BenchAllOptions& options, const CommonOptions& common) {
  BenchAllParams params;
  params.threads = thread_count(common);
  params.rounds = options.rounds;
  params.scale = options.scale;
  params.only = options.only;
  const Machine machine = this_machine();
  std::vector<BenchRow> rows;
  {
    Progress progress(common, "measuring", "rows");
    rows = bench_all(params, [&](int done, int all) { progress.update(std::uint64_t(done), std::uint64_t(all)); });
  }
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::string text = fmt::format("{}, {} of {} threads, {}\n", machine.cpu, params.threads, machine.cores, machine.isa);
  for (const BenchRow& row : rows) {
    list.push_back({{"loop", row.name},
                    {"unit", row.unit},
                    {"per_s", row.per_s},
                    {"bound", row.bound},
                    {"bound_per_s", row.bound_per_s},
                    {"ratio", row.ratio}});
    text += fmt::format("{:<32} {:>8} {:<17} {:>8}/s {:<42} {:>7.3f}\n", row.name, format_count(row.per_s) + "/s",
                        row.unit, format_count(row.bound_per_s), row.bound, row.ratio);
  }
  print_result(common,
               {{"cpu", machine.cpu},
                {"isa", machine.isa},
                {"cores", machine.cores},
                {"threads", params.threads},
                {"rounds", params.rounds},
                {"scale", params.scale},
                {"rows", list}},
               text);
}

}  // namespace

void add_bench_all_command(Command bench, CommonOptions& common) {
  Command command = bench.add_subcommand(
      "all", "Every inner loop beside its bound, measured in turn, with the machine's name: see docs/bench.md.");
  auto options = std::make_shared<BenchAllOptions>();
  command.add_option("--rounds", options->rounds, "Measurements in turn; medians are reported").within(1, 1000);
  command.add_option("--scale", options->scale, "Amount of work in each, as a share of the usual")
      .within(0.001, 1000.0);
  command.add_option("--only", options->only, "Rows whose names have this in them").type_name("TEXT");
  command.footer(
      "Scenes and maps are made in memory. Rates count the process's own time over its threads.\n"
      "--json: cpu, isa, cores, threads, and rows of loop, unit, per_s, bound, bound_per_s, ratio.\n"
      "\nExample:\n"
      "  ivory bench all --threads 1 --json");
  set_action(command, common, Output::none, [options, &common] { run(*options, common); });
}

}  // namespace ivory
