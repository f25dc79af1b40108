#include "tools/input/environment.h"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/env/turned_map.h"
#include "grid/io/file.h"
#include "tools/cli/host.h"
#include "tools/input/assumptions.h"
#include "tools/input/shared.h"

namespace ivory {

namespace {

const std::string turn_key = "environment_turn_deg";  // of metadata; none stands for 0

}  // namespace

double environment_turn_deg(const Metadata& metadata) { return find_number(metadata, turn_key).value_or(0); }

Option add_layout_option(Command command, EnvironmentChoice& choice) {
  return command
      .add_option(
          "--layout",
          [&choice](const std::string& name) {
            from_name<EnvironmentLayout>(name);
            choice.layout = name;
          },
          "How the map lays out the sphere: latlong 2:1, angular 1:1, vertical_cross 3:4, horizontal_cross 4:3,\n"
          "cube 1:6, cube_row 6:1 [its envmap attribute, else its aspect]")
      .type_name("NAME");
}

void add_environment_options(Command command, EnvironmentChoice& choice, const std::string& group) {
  Option environment =
      command
          .add_option("--env", choice.path,
                      "Environment map in nits: .exr, .hdr or other image; +Z in the middle, +X to its left, +Y up")
          .type_name("IMAGE");
  Option layout = add_layout_option(command, choice).needs(environment);
  Option turn = command
                    .add_option("--env-turn", choice.turn_deg,
                                "Turns the environment about +Y, counter-clockwise seen from above")
                    .within(-36000.0, 36000.0)
                    .needs(environment)
                    .type_name("DEGREES");
  if (group.empty()) return;
  for (Option* option : {&environment, &layout, &turn}) option->group(group);
}

EnvironmentInput load_environment_input(const EnvironmentChoice& choice) {
  std::optional<EnvironmentLayout> layout;
  if (!choice.layout.empty()) layout = from_name<EnvironmentLayout>(choice.layout);
  const std::string hash = file_hash(choice.path);
  LoadedEnvironment loaded = load_environment_image(choice.path, layout);
  // The hash is to be that of the image.
  if (file_hash(choice.path) != hash)
    throw Error(choice.path, "changed while it was read", "try again when it is written");
  EnvironmentInput input{std::move(loaded.image), std::move(loaded.facts), std::move(loaded.warnings)};
  input.origin["environment"] = std::filesystem::path(choice.path).filename().string();
  input.origin["environment_hash"] = hash;
  input.origin["environment_layout"] = std::string(name_of(input.image.layout));
  if (choice.turn_deg != 0) {
    input.image.map = turned(to_latlong(std::move(input.image)), choice.turn_deg);
    input.image.layout = EnvironmentLayout::latlong;
    input.origin[turn_key] = choice.turn_deg;
  }
  keep_assumptions(input.origin, input.warnings);
  return input;
}

EnvironmentInput load_environment_input(const EnvironmentChoice& choice, const CommonOptions& common) {
  begin_work(common);
  if (common.host == nullptr || common.host->inputs == nullptr) return load_environment_input(choice);
  return *common.host->inputs->environments.get(fmt::format("{}\n{}\n{}", choice.path, choice.layout, choice.turn_deg),
                                                choice.path, [&] { return load_environment_input(choice); });
}

}  // namespace ivory
