// ivory probe GRID.vdb: irradiance read from a grid.
#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "grid/base/error.h"
#include "grid/io/file.h"
#include "tools/cli/scene_input.h"
#include "tools/cli/vdb_input.h"
#include "tools/probe/source.h"
#include "tracer/render/guard_rays.h"

namespace ivory {

namespace {

struct GridOptions {
  std::string scene;
  std::string guard;
  std::string interpolation = "trilinear";
  std::string reconstruction = "optimal";
  float nudge_voxels = LookupParams{}.nudge_voxels;
};

// The guard asked for, or the best that the inputs allow.
Guard choose_guard(const std::string& source, const GridOptions& options, const IrradianceGrid& grid) {
  if (options.guard.empty()) {
    if (!options.scene.empty()) return Guard::rays;
    return grid.guard.empty() ? Guard::off : Guard::planes;
  }
  const Guard guard = from_name<Guard>(options.guard);
  if (guard == Guard::rays && options.scene.empty()) throw UsageError("--guard rays needs the scene: give --scene");
  if (guard != Guard::rays && !options.scene.empty()) throw UsageError("--scene serves --guard rays only");
  if (guard == Guard::planes && grid.guard.empty())
    throw Error(source, "stores no compact guard", "bake it with --guard planes or rays, or give --guard off");
  return guard;
}

ProbeEstimates probe_grid(const GridOptions& options, const ProbeRequest& request) {
  const PointsTable& table = request.table;
  const CommonOptions& common = request.common;
  const IrradianceGrid grid = load_grid_vdb(request.source);
  const Guard guard = choose_guard(request.source, options, grid);
  LookupParams params;
  params.interpolation = from_name<Interpolation>(options.interpolation);
  params.reconstruction = from_name<Reconstruction>(options.reconstruction);
  params.nudge_voxels = options.nudge_voxels;
  if (params.reconstruction == Reconstruction::paper && grid.basis != Basis::vectors) {
    throw UsageError(fmt::format("--reconstruction paper reads basis 'vectors' only; {} stores '{}'", request.source,
                                 name_of(grid.basis)));
  }
  if (request.indirect_only && grid.light != StoredLight::indirect)
    throw Error(request.source, "was baked with --direct and cannot be read without", "bake it again without --direct");

  std::optional<SceneInput> scene;
  if (!options.scene.empty()) {
    scene = load_scene_input(options.scene, {}, common);
    const auto baked = find_text(grid.metadata, "scene_hash");
    if (baked && *baked != scene->lit.scene->content_hash)
      print_note(common, "warning: " + options.scene + " has changed since " + request.source + " was baked");
  }
  const Intersector* intersector = scene ? &scene->lit.intersector : nullptr;

  ProbeEstimates out;
  out.e.resize(table.p.size());
  out.standard_error.resize(table.p.size());
  tbb::parallel_for(std::size_t(0), table.p.size(), [&](std::size_t i) {
    const V3f& n = table.n[i];
    const Footprint footprint = lookup_footprint(grid, intersector, guard, table.p[i], n, params);
    out.e[i] = irradiance(grid, footprint, n, params.reconstruction);
    out.standard_error[i] = irradiance_standard_error(grid, footprint);
  });
  const auto outside = std::count_if(table.p.begin(), table.p.end(), [&](const V3f& p) {
    const V3f index = grid.frame.to_index(p);
    for (int axis = 0; axis < 3; ++axis) {
      // A vertex' cell reaches half a spacing beyond it.
      if (!(index[axis] >= -0.5F && index[axis] <= float(grid.frame.size[axis]) - 0.5F)) return true;
    }
    return false;
  });
  if (outside > 0) {
    print_note(common, fmt::format("warning: {} of {} points lie outside the grid and read its nearest vertices",
                                   outside, table.p.size()));
  }
  out.facts = {
      {"source", std::string("grid")}, {"guard", std::string(name_of(guard))}, {"outside", std::int64_t(outside)}};
  return out;
}

}  // namespace

ProbeSource make_grid_source(Command command) {
  auto options = std::make_shared<GridOptions>();
  const std::string grids = "For grids";
  command.add_option("--scene", options->scene, "The scene that was baked, for --guard rays")
      .type_name("SCENE")
      .group(grids);
  command
      .add_option("--guard", options->guard,
                  "What keeps leaks out: rays [with --scene], the stored planes\n[where there are any], off")
      .one_of({"rays", "planes", "off"})
      .group(grids);
  command.add_option("--interpolation", options->interpolation, "Between vertices")
      .one_of({"trilinear", "tricubic"})
      .group(grids);
  command.add_option("--reconstruction", options->reconstruction, "From stored moments to E(n)")
      .one_of({"optimal", "paper"})
      .group(grids);
  command.add_option("--nudge", options->nudge_voxels, "Points move this far along n first, in voxels")
      .within(0.0, 2.0)
      .group(grids);

  ProbeSource source;
  source.name = "grids";
  source.options = {"--scene", "--guard", "--interpolation", "--reconstruction", "--nudge"};
  source.matches = [](const std::string& path) { return lower_extension(path) == ".vdb"; };
  source.probe = [options](const ProbeRequest& request) { return probe_grid(*options, request); };
  return source;
}

}  // namespace ivory
