#include "tools/cli/grid_input.h"

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/cli/vdb_input.h"

namespace ivory {

std::shared_ptr<GridInputOptions> add_grid_options(Command command, const std::string& purpose) {
  auto options = std::make_shared<GridInputOptions>();
  command.add_option("--grid", options->grid, purpose).type_name("GRID.vdb");
  command.add_option("--guard", options->guard, "Leak guard of grid look-ups").one_of({"rays", "planes", "off"});
  command.add_option("--interpolation", options->interpolation, "Between grid vertices; tricubic is the B-spline")
      .one_of({"trilinear", "tricubic"});
  command.add_option("--reconstruction", options->reconstruction, "Of irradiance from the stored vectors")
      .one_of({"optimal", "paper"});
  return options;
}

const std::vector<std::string>& grid_option_names() {
  static const std::vector<std::string> names{"--grid", "--guard", "--interpolation", "--reconstruction"};
  return names;
}

IrradianceGrid load_grid(const GridInputOptions& options, const SceneInput& input, const CommonOptions& common) {
  IrradianceGrid grid = load_grid_vdb(options.grid);
  if (grid.light != StoredLight::indirect)
    throw Error(options.grid, "holds direct light, which rendering would count twice", "bake it without --direct");
  if (options.guard == "planes" && grid.guard.empty())
    throw Error(options.grid, "stores no guard planes", "bake it with --guard planes, or render with --guard rays");
  check_environment(options.grid, grid.metadata, input);
  if (const auto hash = find_text(grid.metadata, "scene_hash"); hash && *hash != input.lit.scene->content_hash) {
    print_note(common, fmt::format("note: {} was baked from another scene ({})", options.grid,
                                   find_text(grid.metadata, "scene").value_or("")));
  }
  if (options.reconstruction == "paper" && grid.basis != Basis::vectors)
    throw UsageError(fmt::format("--reconstruction paper needs a grid of basis vectors, {} has {}", options.grid,
                                 name_of(grid.basis)));
  return grid;
}

GridLight grid_light(const GridInputOptions& options, const IrradianceGrid& grid) {
  GridLight light;
  light.grid = &grid;
  light.guard = from_name<Guard>(options.guard);
  light.lookup.interpolation = from_name<Interpolation>(options.interpolation);
  light.lookup.reconstruction = from_name<Reconstruction>(options.reconstruction);
  return light;
}

void describe(const GridInputOptions& options, Metadata& metadata) {
  metadata["grid"] = options.grid.substr(options.grid.find_last_of('/') + 1);
  metadata["guard"] = options.guard;
  metadata["interpolation"] = options.interpolation;
  metadata["reconstruction"] = options.reconstruction;
}

}  // namespace ivory
