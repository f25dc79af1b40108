// ivory probe SCENE: irradiance by path tracing, the truth.
#include "tools/input/scene.h"

#include <limits>
#include <memory>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/probe/source.h"
#include "tracer/render/probe.h"

namespace ivory {

namespace {

struct PathOptions {
  EnvironmentChoice environment;
  int samples = 1024;
  std::uint64_t seed = 1;
  int bounces = ProbeParams{}.max_bounces;
};

ProbeEstimates probe_path_traced(const PathOptions& options, const ProbeRequest& request) {
  const PointsTable& table = request.table;
  const CommonOptions& common = request.common;
  const auto input = load_scene_input(request.source, request.load, options.environment, common);
  std::vector<ProbePoint> points;
  const std::vector<V3f> p = local_points(table, input.lit.scene->anchor_m);
  for (std::size_t i = 0; i < p.size(); ++i) points.push_back({p[i], table.n[i]});
  ProbeParams params;
  params.samples = options.samples;
  params.max_bounces = options.bounces;
  params.seed = options.seed;
  params.threads = thread_count(common);
  params.indirect_only = request.indirect_only;
  Progress progress(common, "probing", "paths");
  const std::uint64_t paths = points.size() * std::uint64_t(options.samples);
  params.progress = [&](double fraction) {
    progress.update(static_cast<std::uint64_t>(fraction * static_cast<double>(paths)), paths);
  };
  ProbeEstimates out;
  std::int64_t unmet = 0;
  constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  for (const ProbeResult& result : probe_scene(input.lit, points, params)) {
    // All samples black: as many as there are say nothing of what the next one may bring.
    const bool met = !is_black(result.e);
    unmet += met ? 0 : 1;
    out.e.push_back(result.e);
    out.standard_error.push_back(met ? result.standard_error : Rgb(unknown, unknown, unknown));
  }
  out.warnings = input.warnings;
  if (unmet > 0) {
    out.doubts.push_back(
        fmt::format("no path from {} of {} points met any light: E is not known to be 0 there, "
                    "and r_se, g_se, b_se are left empty",
                    unmet, points.size()));
  }
  out.facts = {{"unmet", unmet},
               {"source", std::string("scene")},
               {"samples", std::int64_t(options.samples)},
               {"seed", std::int64_t(options.seed)}};
  return out;
}

}  // namespace

ProbeSource make_scene_source(Command command) {
  auto options = std::make_shared<PathOptions>();
  const std::string scenes = "For scenes";
  add_environment_options(command, options->environment, scenes);
  command.add_count("--samples", options->samples, 2, 2'000'000'000, "Paths a point").group(scenes);
  command.add_count("--seed", options->seed, "Seed of the random numbers").group(scenes);
  command.add_count("--bounces", options->bounces, 1, 1'000'000, "Surfaces a path may scatter at").group(scenes);
  ProbeSource source;
  source.name = "scenes";
  source.options = {"--env", "--layout", "--samples", "--seed", "--bounces"};
  source.reads_scenes = true;
  source.matches = is_scene_name;
  source.probe = [options](const ProbeRequest& request) { return probe_path_traced(*options, request); };
  return source;
}

}  // namespace ivory
