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
#include "tools/cli/usage_error.h"
#include "tools/input/vdb.h"

namespace ivory {

namespace {

struct MixOptions {
  std::string grid;
  std::string output;
  GroupFactors factors;
};

// "NAME=VALUE"; `value` in words.
std::pair<std::string, std::string> parse_assignment(const char* option, const std::string& text, const char* value) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw UsageError(fmt::format("{}: '{}' is not a group and {}, as hall={}", option, text, value, value));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

void multiply(GroupFactors& factors, const std::string& group, const Rgb& factor) {
  factors.try_emplace(group, Rgb(1, 1, 1)).first->second *= factor;
}

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
    const std::string line = fmt::format("{}={},{},{}", group.name, factor.x, factor.y, factor.z);
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
  command
      .add_option(
          "--scale",
          [options](const std::string& text) {
            const auto [group, value] = parse_assignment("--scale", text, "FACTOR");
            const auto factor = parse_number(value);
            if (!factor || !(*factor >= 0)) throw UsageError("--scale: '" + value + "' is not a factor of 0 or more");
            multiply(options->factors, group, Rgb(1, 1, 1) * float(*factor));
          },
          "What a group's light is multiplied by; may be repeated [1]")
      .repeated()
      .type_name("GROUP=FACTOR");
  command
      .add_option(
          "--tint",
          [options](const std::string& text) {
            const auto [group, value] = parse_assignment("--tint", text, "R,G,B");
            const V3d tint = parse_vector3("--tint", value);
            if (!(tint.x >= 0 && tint.y >= 0 && tint.z >= 0))
              throw UsageError("--tint: '" + value + "' is not three factors of 0 or more");
            multiply(options->factors, group, Rgb(tint));
          },
          "What the channels of a group's light are multiplied by, in linear Rec.709; may be repeated [1,1,1]")
      .repeated()
      .type_name("GROUP=R,G,B");
  command.footer(
      "Light adds up: the mix is what a bake of lamps so dimmed and coloured gives, without tracing anything again.\n"
      "With neither option it is the grid as it would have been baked without --groups, to the byte.\n"
      "\nExamples:\n"
      "  ivory bake grid house.glb -o house.vdb --groups sun=@suns --groups 'hall=Lamp*,Neon*'\n"
      "  ivory mix house.vdb -o evening.vdb --scale sun=0 --scale hall=0.3 --tint hall=1,0.9,0.8");
  set_action(command, common, Output::file, [options, &common] { run_mix(*options, common); });
}

}  // namespace ivory
