// ivory render --method cubemap: dynamic objects lit by a localized cube map.
#include "grid/io/cubemap.h"

#include <memory>
#include <optional>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/input/grid.h"
#include "tools/render/method.h"
#include "tracer/render/object_light.h"

namespace ivory {

namespace {

struct CubemapOptions {
  std::string path;
  CubeMethod lookup = CubeMethod::polygon;
  std::shared_ptr<GridInputOptions> grid;
};

Rendered render_cubemap(const CubemapOptions& options, const RenderRequest& request) {
  const CommonOptions& common = request.common;
  LocalizedCube cube = read_localized_cube(options.path);
  set_anchor(cube, request.input.lit.scene->anchor_m);
  check_environment(options.path, cube.metadata, request.input);
  check_scale(options.path, cube.metadata, request.input.origin);
  if (const auto baked = find_text(cube.metadata, "scene_hash");
      baked && *baked != request.input.lit.scene->content_hash)
    print_note(common, fmt::format("note: {} was baked from another scene", options.path));
  ObjectLightParams params;
  params.is_object = request.is_object;
  std::optional<IrradianceGrid> grid;
  GridLight light;
  LookupTally tally;
  if (!options.grid->grid.empty()) {
    grid = load_grid(*options.grid, request.input, common);
    light = {&*grid, options.grid->lookup, &tally};
    params.grid = &light;
  }
  Rendered rendered =
      render_with_cube(request.input.lit, {&cube, options.lookup}, request.view, request.params, params);
  describe(tally, rendered.found);
  rendered.doubts = doubts_about(tally, *options.grid);
  return rendered;
}

}  // namespace

RenderMethod make_cubemap_method(Command command, const std::shared_ptr<GridInputOptions>& grid) {
  auto options = std::make_shared<CubemapOptions>();
  options->grid = grid;
  command.add_option("--cubemap", options->path, "Localized cube map that lights the objects (see ivory bake cubemap)")
      .type_name("MAP.exr");
  command.add_choice("--lookup", options->lookup,
                     "How the cube map is read: texels as polygons; polygons without a cut at the horizon, as\n"
                     "published; points; or a map of 6x16x16 texels convolved at the reference point, distances\n"
                     "ignored");
  RenderMethod method;
  method.name = "cubemap";
  method.summary = "path, or direct with --grid, but --object lit by --cubemap";
  method.options = grid_option_names();
  method.options.insert(method.options.end(), {"--cubemap", "--lookup"});
  method.uses_objects = true;
  method.noise_note = "the noise of samples, not what the cube map is off by";
  method.files = [options] {
    std::vector<std::string> files{options->path};
    if (!options->grid->grid.empty()) files.push_back(options->grid->grid);
    return files;
  };
  method.check = [options] {
    if (options->path.empty()) throw UsageError("--method cubemap needs --cubemap MAP.exr (see ivory bake cubemap)");
  };
  method.render = [options](const RenderRequest& request) { return render_cubemap(*options, request); };
  method.describe = [options](Metadata& m) {
    m["cubemap"] = options->path.substr(options->path.find_last_of('/') + 1);
    m["lookup"] = std::string(name_of(options->lookup));
    if (!options->grid->grid.empty()) describe(*options->grid, m);
  };
  return method;
}

}  // namespace ivory
