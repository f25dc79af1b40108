#include "tools/input/grid.h"

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/input/vdb/load.h"

namespace ivory {

Option add_lookup_options(Command command, LookupParams& params, const std::string& guards, const std::string& group) {
  Option guard = command.add_choice("--guard", params.guard, guards);
  Option interpolation = command.add_choice(
      "--interpolation", params.interpolation,
      "Between grid vertices; tricubic is the B-spline, fitted a linear fit read at the surface (not by the viewer)");
  Option reconstruction =
      command.add_choice("--reconstruction", params.reconstruction, "Of irradiance from the stored vectors");
  if (!group.empty()) {
    for (Option option : {guard, interpolation, reconstruction}) option.group(group);
  }
  return guard;
}

void check_lookup(const std::string& path, Basis basis, bool has_guard, const LookupParams& params) {
  if (params.guard == Guard::planes && !has_guard)
    throw Error(path, "stores no guard planes", "bake it with --guard planes, or read it with --guard rays or off");
  if (!reads(params.reconstruction, basis)) {
    throw UsageError(fmt::format("--reconstruction {}: it reads a grid of basis vectors only, {} has {}",
                                 name_of(params.reconstruction), path, name_of(basis)));
  }
}

std::shared_ptr<GridInputOptions> add_grid_options(Command command, const std::string& purpose) {
  auto options = std::make_shared<GridInputOptions>();
  command.add_option("--grid", options->grid, purpose).type_name("GRID.vdb");
  add_lookup_options(command, options->lookup,
                     "Leak guard of grid look-ups; gather, unless it is given, reads by planes, and by rays "
                     "where those\nleave a doubt");
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
  check_lookup(options.grid, grid.basis, !grid.guard.empty(), options.lookup);
  check_environment(options.grid, grid.metadata, input);
  check_scale(options.grid, grid.metadata, input.origin);
  if (const auto hash = find_text(grid.metadata, "scene_hash"); hash && *hash != input.lit.scene->content_hash) {
    print_note(common, fmt::format("note: {} was baked from another scene ({})", options.grid,
                                   find_text(grid.metadata, "scene").value_or("")));
  }
  set_anchor(grid, input.lit.scene->anchor_m);
  return grid;
}

void describe(const GridInputOptions& options, Metadata& metadata) {
  metadata["grid"] = options.grid.substr(options.grid.find_last_of('/') + 1);
  metadata["guard"] = std::string(name_of(options.lookup.guard));
  metadata["interpolation"] = std::string(name_of(options.lookup.interpolation));
  metadata["reconstruction"] = std::string(name_of(options.lookup.reconstruction));
}

namespace {

double share_of(std::int64_t count, const LookupTally& tally) {
  return tally.lookups() > 0 ? double(count) / double(tally.lookups()) : 0;
}

}  // namespace

void describe(const LookupTally& tally, Metadata& metadata) {
  if (tally.unseen() > 0) metadata["grid_unseen_share"] = share_of(tally.unseen(), tally);
  if (tally.outside() > 0) metadata["grid_outside_share"] = share_of(tally.outside(), tally);
}

std::vector<std::string> doubts_about(const LookupTally& tally, const GridInputOptions& options) {
  constexpr double worth_a_word = 1e-3;
  std::vector<std::string> doubts;
  if (const double share = share_of(tally.unseen(), tally); share > worth_a_word) {
    doubts.push_back(
        fmt::format("{}: no vertex sees the place of {:.2g} % of the look-ups, and they read 0: bake with a finer "
                    "--voxel-size or wider --bounds",
                    options.grid, 100 * share));
  }
  if (const double share = share_of(tally.outside(), tally); share > worth_a_word) {
    doubts.push_back(fmt::format("{}: {:.2g} % of the look-ups lie outside the grid and read its nearest vertices",
                                 options.grid, 100 * share));
  }
  return doubts;
}

}  // namespace ivory
