// ivory render --method direct | gather: indirect light from a baked grid.
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "grid/error.h"
#include "grid/io_vdb.h"
#include "tools/render_method.h"
#include "tracer/final_gather.h"

namespace ivory {

namespace {

struct GridOptions {
  std::string grid;
  std::string guard = "rays";
  std::string interpolation = "trilinear";
  std::string reconstruction = "optimal";
  std::uint64_t gather = 16;
};

// A grid that final gather can add direct light to, and that has what the guard needs.
IrradianceGrid load_grid(const GridOptions& options, const SceneInput& input, const CommonOptions& common) {
  IrradianceGrid grid = read_grid_vdb(options.grid);
  const auto text = [&](const char* key) {
    const auto found = grid.metadata.find(key);
    const auto* value = found == grid.metadata.end() ? nullptr : std::get_if<std::string>(&found->second);
    return value == nullptr ? std::string() : *value;
  };
  if (text("light") == "direct and indirect")
    throw Error(options.grid, "holds direct light, which rendering would count twice", "bake it without --direct");
  if (options.guard == "planes" && grid.guard.empty())
    throw Error(options.grid, "stores no guard planes", "bake it with --guard planes, or render with --guard rays");
  if (!text("scene_hash").empty() && text("scene_hash") != input.scene.content_hash)
    print_note(common, fmt::format("note: {} was baked from another scene ({})", options.grid, text("scene")));
  if (options.reconstruction == "paper" && grid.basis != Basis::vectors)
    throw UsageError(
        fmt::format("--reconstruction paper needs a grid of basis vectors, {} has {}", options.grid, name(grid.basis)));
  return grid;
}

Film render_grid(const GridOptions& options, bool gather, const RenderRequest& request) {
  const IrradianceGrid grid = load_grid(options, request.input, request.common);
  GridLight light;
  light.grid = &grid;
  light.guard = guard_from_name(options.guard);
  light.lookup.interpolation = options.interpolation == "tricubic" ? Interpolation::tricubic : Interpolation::trilinear;
  light.lookup.reconstruction = reconstruction_from_name(options.reconstruction);
  GatherParams params;
  params.gather_rays = gather ? int_count("--gather", options.gather, 1) : 0;
  params.indirect_only = request.indirect_only;
  return render_gather(*request.input.intersector, *request.input.lights, light, request.view, request.params, params);
}

RenderMethod make_method(const std::shared_ptr<GridOptions>& options, bool gather) {
  RenderMethod method;
  method.name = gather ? "gather" : "direct";
  method.summary = gather ? "final gather, one bounce before --grid is read" : "indirect light read from --grid";
  method.options = {"--grid", "--guard", "--interpolation", "--reconstruction"};
  if (gather) method.options.push_back("--gather");
  method.check = [options, gather] {
    if (options->grid.empty())
      throw UsageError(
          fmt::format("--method {} needs --grid GRID.vdb (see ivory bake grid)", gather ? "gather" : "direct"));
    if (gather) int_count("--gather", options->gather, 1);
  };
  method.render = [options, gather](const RenderRequest& request) { return render_grid(*options, gather, request); };
  method.describe = [options, gather](Metadata& m) {
    m["grid"] = options->grid.substr(options->grid.find_last_of('/') + 1);
    m["guard"] = options->guard;
    m["interpolation"] = options->interpolation;
    m["reconstruction"] = options->reconstruction;
    if (gather) m["gather_rays"] = std::int64_t(options->gather);
  };
  return method;
}

}  // namespace

std::vector<RenderMethod> make_grid_methods(CLI::App& command) {
  auto options = std::make_shared<GridOptions>();
  command.add_option("--grid", options->grid, "Baked grid of indirect light")->type_name("GRID.vdb");
  add_count_option(command, "--gather", options->gather, "Rays a sample (gather)");
  command.add_option("--guard", options->guard, "Leak guard of grid look-ups")
      ->check(CLI::IsMember({"rays", "planes", "off"}))
      ->capture_default_str();
  command.add_option("--interpolation", options->interpolation, "Between grid vertices; tricubic is the B-spline")
      ->check(CLI::IsMember({"trilinear", "tricubic"}))
      ->capture_default_str();
  command.add_option("--reconstruction", options->reconstruction, "Of irradiance from the stored vectors")
      ->check(CLI::IsMember({"optimal", "paper"}))
      ->capture_default_str();
  return {make_method(options, false), make_method(options, true)};
}

}  // namespace ivory
