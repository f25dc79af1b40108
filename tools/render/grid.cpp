// ivory render --method direct | gather: indirect light from a baked grid.
#include "tools/input/grid.h"

#include <memory>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/render/method.h"
#include "tracer/render/final_gather.h"

namespace ivory {

namespace {

struct GatherOptions {
  std::shared_ptr<GridInputOptions> grid;
  std::shared_ptr<int> gather;
};

Rendered render_grid(const GatherOptions& options, bool gather, const RenderRequest& request) {
  const IrradianceGrid grid = load_grid(*options.grid, request.input, request.common);
  GatherParams params;
  params.gather_rays = gather ? *options.gather : 0;
  params.indirect_only = request.indirect_only;
  const LitScene& lit = request.input.lit;
  LookupTally tally;
  const GridLight light{&grid, options.grid->lookup, &tally};
  Rendered rendered = render_gather(lit, indirect_light(lit, light), request.view, request.params, params);
  describe(tally, rendered.found);
  rendered.doubts = doubts_about(tally, *options.grid);
  return rendered;
}

RenderMethod make_method(const std::shared_ptr<GatherOptions>& options, bool gather) {
  RenderMethod method;
  method.name = gather ? "gather" : "direct";
  method.summary = gather ? "final gather, one bounce before --grid is read" : "indirect light read from --grid";
  method.options = grid_option_names();
  if (gather) method.options.push_back("--gather");
  method.check = [options, gather] {
    if (options->grid->grid.empty()) {
      throw UsageError(
          fmt::format("--method {} needs --grid GRID.vdb (see ivory bake grid)", gather ? "gather" : "direct"));
    }
    if (gather && *options->gather < 1) throw UsageError("--gather: --method gather needs a ray at least");
  };
  method.noise_note = "the noise of samples, not what the grid is off by";
  method.files = [options] { return std::vector<std::string>{options->grid->grid}; };
  method.render = [options, gather](const RenderRequest& request) { return render_grid(*options, gather, request); };
  method.describe = [options, gather](Metadata& m) {
    describe(*options->grid, m);
    if (gather) m["gather_rays"] = std::int64_t(*options->gather);
  };
  return method;
}

}  // namespace

std::shared_ptr<int> add_gather_option(Command command) {
  auto gather = std::make_shared<int>(16);
  command.add_count("--gather", *gather, 0, "Rays a sample");
  return gather;
}

std::vector<RenderMethod> make_grid_methods(const std::shared_ptr<GridInputOptions>& grid,
                                            const std::shared_ptr<int>& gather) {
  auto options = std::make_shared<GatherOptions>();
  options->grid = grid;
  options->gather = gather;
  return {make_method(options, false), make_method(options, true)};
}

}  // namespace ivory
