// ivory mix: the groups of lights of a grid, dimmed and coloured after the bake.
#include "grid/field/mix.h"

#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/io/file.h"
#include "grid/io/vdb/vdb.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/group_factors.h"
#include "tools/input/vdb/load.h"

namespace ivory {

namespace {

struct MixOptions {
  std::string grid;
  std::string output;
  GroupFactors factors;
};

void run_mix(const MixOptions& options, const CommonOptions& common) {
  check_output(options.output, ".vdb", common);
  const IrradianceGrid grid = load_grid_vdb(options.grid, /*with_groups=*/true);
  IrradianceGrid mixed = [&] {
    try {
      return mix_groups(grid, options.factors);
    } catch (const ParameterError& error) {
      throw Error(options.grid, "cannot be mixed: " + error.cause(),
                  grid.groups.empty() ? "bake it with --groups" : "name groups that it has, factors of 0 and more");
    }
  }();
  nlohmann::ordered_json groups = nlohmann::ordered_json::array();
  std::string text;
  std::string changes;
  for (const GridGroup& group : grid.groups) {
    const auto found = options.factors.find(group.name);
    const Rgb factor = found == options.factors.end() ? Rgb(1, 1, 1) : found->second;
    groups.push_back({{"name", group.name}, {"factor", {factor.x, factor.y, factor.z}}});
    const std::string line = text_of(group.name, factor);
    text += "  " + line + "\n";
    if (factor != Rgb(1, 1, 1)) changes += (changes.empty() ? "" : " ") + line;
  }
  if (changes.empty()) {
    // By way of the moments rounding would change bits.
    write_file(options.output, ungrouped_vdb(options.grid), common.force);
  } else {
    mixed.metadata["mix"] = changes;
    write_vdb(options.output, mixed, common.force);
  }
  const auto bytes = std::filesystem::file_size(options.output);
  print_result(common, {{"file", options.output}, {"bytes", bytes}, {"groups", groups}},
               fmt::format("{}: {}, of the groups, times\n{}", options.output, format_bytes(bytes), text));
}

}  // namespace

void add_mix_command(Command app, CommonOptions& common) {
  Command command = app.add_subcommand("mix", "Dim and colour groups of lights of a grid (bake grid --groups)");
  auto options = std::make_shared<MixOptions>();
  command.add_option("grid", options->grid, "Grid baked with --groups").required().type_name("GRID.vdb");
  command.add_option("-o,--output", options->output, "Grid to write, .vdb").required().type_name("OUT.vdb");
  add_group_factor_options(command, options->factors);
  command.footer(
      "Light adds up: the mix is what a bake of lamps so dimmed and coloured gives, without tracing anything again.\n"
      "With neither option it is the grid as it would have been baked without --groups, to the byte.\n"
      "\nExamples:\n"
      "  ivory bake grid house.glb -o house.vdb --groups sun=@suns --groups 'hall=Lamp*,Neon*'\n"
      "  ivory mix house.vdb -o evening.vdb --scale sun=0 --scale hall=0.3 --tint hall=1,0.9,0.8");
  set_action(command, common, Output::file, [options, &common] { run_mix(*options, common); });
}

}  // namespace ivory
