#include "tools/input/environment.h"

#include <filesystem>
#include <utility>

#include "grid/base/error.h"
#include "grid/io/file.h"
#include "tools/cli/host.h"
#include "tools/input/assumptions.h"
#include "tools/input/shared.h"

namespace ivory {

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
  if (group.empty()) return;
  environment.group(group);
  layout.group(group);
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
  keep_assumptions(input.origin, input.warnings);
  return input;
}

EnvironmentInput load_environment_input(const EnvironmentChoice& choice, const CommonOptions& common) {
  begin_work(common);
  if (common.host == nullptr || common.host->inputs == nullptr) return load_environment_input(choice);
  return *common.host->inputs->environments.get(choice.path + "\n" + choice.layout, choice.path,
                                                [&] { return load_environment_input(choice); });
}

}  // namespace ivory
