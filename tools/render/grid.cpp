// ivory render --method direct | gather: indirect light from a baked grid.
#include "tools/input/grid.h"

#include <memory>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/render/method.h"
#include "tracer/render/gather/fill.h"

namespace ivory {

namespace {

enum class Reuse { on, off };

}  // namespace

template <>
inline constexpr auto name_table<Reuse> = make_name_table<Reuse>("cache", {{Reuse::on, "on"}, {Reuse::off, "off"}});

namespace {

struct GatherOptions {
  std::shared_ptr<GridInputOptions> grid;
  std::shared_ptr<int> gather;
  Reuse cache = Reuse::on;
  int cache_rays = CacheParams{}.rays;
  float cache_error = CacheParams{}.error;
  std::optional<Option> guard;

  bool guard_given() const { return guard->given(); }
};

Rendered render_grid(const GatherOptions& options, bool gather, const RenderRequest& request) {
  const IrradianceGrid grid = load_grid(*options.grid, request.input, request.common);
  GatherParams params;
  params.gather_rays = gather ? *options.gather : 0;
  params.indirect_only = request.indirect_only;
  const LitScene& lit = request.input.lit;
  LookupTally tally;
  const bool in_doubt = gather && !options.guard_given();
  const GridLight light{&grid, options.grid->lookup, &tally, in_doubt};
  const IndirectLight indirect = indirect_light(lit, light);
  std::optional<FilledCache> filled;
  if (gather && options.cache == Reuse::on) {
    Progress progress(request.common, "filling the cache", "pixels");
    const auto pixels = std::uint64_t(request.view.width) * std::uint64_t(request.view.height);
    const CacheParams cache{
        .rays = options.cache_rays,
        .error = options.cache_error,
        .samples = request.params.samples,
        .gather_rays = params.gather_rays,
        .seed = request.params.seed,
        .threads = request.params.threads,
        .progress = [&](double fraction) { progress.update(std::uint64_t(fraction * double(pixels)), pixels); }};
    filled = fill_cache(lit, indirect, request.view, params, cache);
    params.cache = &filled->cache;
  }
  Rendered rendered = render_gather(lit, indirect, request.view, request.params, params);
  if (filled) {
    rendered.found["cache_records"] = std::int64_t(filled->cache.size());
    rendered.found["cache_uncovered_share"] = filled->uncovered;
  }
  describe(tally, rendered.found);
  rendered.doubts = doubts_about(tally, *options.grid);
  return rendered;
}

RenderMethod make_method(const std::shared_ptr<GatherOptions>& options, bool gather) {
  RenderMethod method;
  method.name = gather ? "gather" : "direct";
  method.summary = gather ? "final gather, one bounce before --grid is read" : "indirect light read from --grid";
  method.options = grid_option_names();
  if (gather) {
    for (const char* name : {"--gather", "--cache", "--cache-rays", "--cache-error"}) method.options.emplace_back(name);
  }
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
    if (!gather) return;
    if (!options->guard_given()) m["guard"] = std::string("planes, rays in doubt");
    m["gather_rays"] = std::int64_t(*options->gather);
    m["cache"] = std::string(name_of(options->cache));
    if (options->cache == Reuse::off) return;
    m["cache_rays"] = std::int64_t(rays_of(split_for(options->cache_rays)));
    m["cache_error"] = double(options->cache_error);
  };
  return method;
}

}  // namespace

std::shared_ptr<int> add_gather_option(Command command) {
  auto gather = std::make_shared<int>(1);
  command.add_count("--gather", *gather, 0, "Rays a sample; of gather with --cache on, where no record serves");
  return gather;
}

std::vector<RenderMethod> make_grid_methods(Command command, const std::shared_ptr<GridInputOptions>& grid,
                                            const std::shared_ptr<int>& gather) {
  auto options = std::make_shared<GatherOptions>();
  options->grid = grid;
  options->gather = gather;
  options->guard = command.get_option("--guard");
  command.add_choice("--cache", options->cache,
                     "Gather at records that pixels share (irradiance cache), and by --gather rays only elsewhere");
  command.add_count("--cache-rays", options->cache_rays, 1, 1000000, "Rays a record");
  command
      .add_option("--cache-error", options->cache_error,
                  "Relative error of E at which records end; smaller makes more of them")
      .within(1e-4, 10.0);
  return {make_method(options, false), make_method(options, true)};
}

}  // namespace ivory
