#include "tools/bake/grid/probes.h"

#include <algorithm>
#include <chrono>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/io/json.h"
#include "grid/io/vdb/vdb.h"
#include "tools/bake/facts.h"

namespace ivory {

void add_probe_bake_options(Command command, ProbeBakeOptions& options) {
  command.add_choice("--by", options.by,
                     "What finds the light: photons, or probes, paths traced from each vertex by itself, as engines\n"
                     "bake: the same file, indirect light alone, for comparison; needs --resolution or --voxel-size");
  command
      .add_option(
          "--probe-rays",
          [&options](const std::string& text) {
            const std::uint64_t rays = parse_count("--probe-rays", text);
            if (rays < 1 || rays > std::uint64_t(max_probe_rays))
              throw UsageError(fmt::format("--probe-rays must be from 1 to {}", max_probe_rays));
            options.rays = int(rays);
            options.rays_given = true;
          },
          fmt::format("Paths from each vertex of --by probes [{}]", default_probe_rays))
      .type_name("COUNT");
}

void check_probe_bake(const ProbeBakeOptions& options, const GridBakeParams& params, bool contract, bool checkpoint) {
  if (!options) {
    if (options.rays_given) throw UsageError("--probe-rays serves --by probes only");
    return;
  }
  const auto refuse = [](bool given, const char* option) {
    if (given) throw UsageError(fmt::format("--by probes: {} serves photons only", option));
  };
  const GridBakeParams defaults;
  refuse(params.photons != 0, "--photons");
  refuse(params.photon_range.has_value(), "--photon-range or --shards");
  refuse(params.estimator != defaults.estimator, "--estimator");
  refuse(params.emission != defaults.emission, "--emission");
  refuse(bool(params.include_direct), "--direct or --direct-of");
  refuse(checkpoint, "--checkpoint");
  if (contract)
    throw UsageError("--by probes: give --resolution or --voxel-size; --target-error and --dry-run serve photons only");
}

void run_probe_bake(const std::string& output, const ProbeBakeOptions& options, GridBakeParams params,
                    const SceneInput& input, const CommonOptions& common) {
  const auto start = std::chrono::steady_clock::now();
  IrradianceGrid grid = [&] {
    Progress progress(common, "baking", "probes");
    params.progress = progress.callback();
    return bake_grid_by_probes(input.lit, params, options.rays);
  }();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  keep_origin(input.origin, grid);
  write_vdb(output, grid, common.force);
  const auto stored = std::count_if(grid.visible_fraction.begin(), grid.visible_fraction.end(),
                                    [](float fraction) { return fraction > 0; });
  const GridFrame& frame = grid.finest_frame();
  const std::int64_t bytes_a_vertex = std::int64_t(grid.stride() + 1) * std::int64_t(sizeof(float)) +
                                      (grid.guard.empty() ? 0 : std::int64_t(sizeof(GuardRecord)));
  const nlohmann::ordered_json result{
      {"file", output},
      {"kind", "grid"},
      {"bytes", std::filesystem::file_size(output)},
      {"resolution", {frame.size.x, frame.size.y, frame.size.z}},
      {"spacing_m", {shortest(frame.spacing_m.x), shortest(frame.spacing_m.y), shortest(frame.spacing_m.z)}},
      {"origin_m", shortest(frame.origin_m, grid.anchor_m)},
      {"vertices", grid.vertex_count()},
      {"vertices_stored", stored},
      {"memory_bytes", stored * bytes_a_vertex},
      {"probe_rays", options.rays},
      {"parameters", to_json(grid.metadata)},
      {"seconds", seconds},
      {"warnings", input.warnings}};
  print_result(
      common, result,
      fmt::format("{}: grid of {} vertices ({} stored), {:.4g} x {:.4g} x {:.4g} m apart{}, {}\n"
                  "indirect light, basis {}, by probes of {} paths\n{:.2f} s on {} threads\n",
                  output, grid.vertex_count(), stored, frame.spacing_m.x, frame.spacing_m.y, frame.spacing_m.z,
                  grid.levels() > 1 ? " on the finest level" : "", format_bytes(std::filesystem::file_size(output)),
                  name_of(grid.basis), options.rays, seconds, params.threads));
}

}  // namespace ivory
