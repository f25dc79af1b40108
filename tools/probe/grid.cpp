// ivory probe GRID.vdb: irradiance read from a grid.
#include "tools/input/grid.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "grid/base/error.h"
#include "grid/field/evidence.h"
#include "grid/io/file.h"
#include "tools/input/scene.h"
#include "tools/input/vdb/load.h"
#include "tools/probe/source.h"
#include "tracer/render/guard_rays_batch.h"

namespace ivory {

namespace {

struct GridOptions {
  std::string scene;
  LookupParams lookup;
  std::optional<Option> guard;  // chosen by hand?
};

// With the guard asked for, or the best that the inputs allow.
LookupParams choose_lookup(const std::string& source, const GridOptions& options, const IrradianceGrid& grid) {
  LookupParams params = options.lookup;
  const bool has_scene = !options.scene.empty();
  if (!options.guard->given()) params.guard = has_scene ? Guard::rays : grid.guard.empty() ? Guard::off : Guard::planes;
  if (params.guard == Guard::rays && !has_scene) throw UsageError("--guard rays needs the scene: give --scene");
  if (params.guard != Guard::rays && has_scene) throw UsageError("--scene serves --guard rays only");
  check_lookup(source, grid.basis, !grid.guard.empty(), params);
  return params;
}

ProbeEstimates probe_grid(const GridOptions& options, const ProbeRequest& request) {
  const PointsTable& table = request.table;
  const CommonOptions& common = request.common;
  const LoadParams& load = request.load.load;
  if (options.scene.empty() && (load.scale != 1 || load.time_s || !load.without.empty()))
    throw UsageError("--scale, --time and --without serve scenes: give --scene");
  IrradianceGrid grid = load_grid_vdb(request.source);
  const LookupParams params = choose_lookup(request.source, options, grid);
  if (request.indirect_only && grid.light != StoredLight::indirect)
    throw Error(request.source, "was baked with --direct and cannot be read without", "bake it again without --direct");

  ProbeEstimates out;
  std::optional<SceneInput> scene;
  if (!options.scene.empty()) {
    scene.emplace(load_scene_input(options.scene, request.load, {}, common));
    check_scale(request.source, grid.metadata, scene->origin);
    const auto baked = find_text(grid.metadata, "scene_hash");
    if (baked && *baked != scene->lit.scene->content_hash)
      out.doubts.push_back(options.scene + " has changed since " + request.source + " was baked");
  }
  if (scene) set_anchor(grid, scene->lit.scene->anchor_m);
  const std::vector<V3f> points = local_points(table, grid.anchor_m);
  const Intersector* intersector = scene ? &scene->lit.intersector : nullptr;

  out.e.resize(table.p.size());
  out.standard_error.resize(table.p.size());
  const std::optional<float> unmet_lux = unmet_bound_lux(grid);
  constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  std::atomic<std::int64_t> unmet = 0;
  std::atomic<std::int64_t> unseen = 0;
  // As many points at a time as lie close together, and yet every thread has some.
  constexpr std::size_t grain = 4096;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), grain), [&](const auto& range) {
    const auto part = [&](const std::vector<V3f>& all) { return std::span(all).subspan(range.begin(), range.size()); };
    const std::vector<GridReading> readings =
        lookup_readings(grid, intersector, {part(points), part(table.n)}, part(table.n), params, unmet_lux.value_or(0));
    for (std::size_t k = 0; k < readings.size(); ++k) {
      const GridReading& reading = readings[k];
      out.e[range.begin() + k] = reading.e;
      if (!reading.seen) {
        ++unseen;
      } else if (!reading.met) {
        ++unmet;
      }
      out.standard_error[range.begin() + k] =
          is_black(reading.standard_error) ? Rgb(unknown, unknown, unknown) : reading.standard_error;
    }
  });
  const auto outside = std::count_if(points.begin(), points.end(), [&](const V3f& p) { return !grid.frame.covers(p); });
  if (scene) out.warnings = scene->warnings;
  if (outside > 0) {
    out.doubts.push_back(
        fmt::format("{} of {} points lie outside the grid and read its nearest vertices", outside, table.p.size()));
  }
  if (unmet > 0) {
    out.doubts.push_back(
        fmt::format("no photon came to the vertices around {} of {} points: E is not known to "
                    "be 0 there, and r_se, g_se, b_se are {}",
                    unmet.load(), table.p.size(), unmet_lux ? "bounds" : "left empty"));
  }
  if (unseen > 0) {
    out.doubts.push_back(
        fmt::format("{} of {} points are seen by no vertex nearby: they read 0, and r_se, g_se, "
                    "b_se are left empty",
                    unseen.load(), table.p.size()));
  }
  out.facts = {{"unmet", unmet.load()},
               {"source", std::string("grid")},
               {"guard", std::string(name_of(params.guard))},
               {"outside", std::int64_t(outside)},
               {"unseen", unseen.load()}};
  return out;
}

}  // namespace

ProbeSource make_grid_source(Command command) {
  auto options = std::make_shared<GridOptions>();
  const std::string grids = "For grids";
  command.add_option("--scene", options->scene, "The scene that was baked, for --guard rays")
      .type_name("SCENE")
      .group(grids);
  options->guard = add_lookup_options(
      command, options->lookup,
      "What keeps leaks out: rays [with --scene], the stored planes\n[where there are any], off", grids);
  options->guard->default_str("");
  command.add_option("--nudge", options->lookup.nudge_voxels, "Points move this far along n first, in voxels")
      .within(0.0, 2.0)
      .group(grids);

  ProbeSource source;
  source.name = "grids";
  source.options = {"--scene", "--guard", "--interpolation", "--reconstruction", "--nudge"};
  source.reads_scenes = true;
  source.matches = [](const std::string& path) { return lower_extension(path) == ".vdb"; };
  source.probe = [options](const ProbeRequest& request) { return probe_grid(*options, request); };
  return source;
}

}  // namespace ivory
