// ivory probe: irradiance at given points, from any asset, or path-traced from a scene.
#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/io/json.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/points.h"
#include "tools/probe/source.h"

namespace ivory {

namespace {

struct ProbeOptions {
  std::string source;
  std::string points;
  std::string output;
  bool indirect_only = false;
  SceneOptions load;
};

const ProbeSource& choose_source(const std::string& path, const std::vector<ProbeSource>& sources) {
  for (const ProbeSource& source : sources) {
    if (source.matches(path)) return source;
  }
  std::string names;
  for (const ProbeSource& source : sources) names += (names.empty() ? "" : ", ") + source.name;
  throw Error(path, "is nothing that can be probed", "give one of: " + names);
}

void run_probe(const ProbeOptions& options, const std::vector<ProbeSource>& sources, const Command& command,
               const CommonOptions& common) {
  const ProbeSource& source = choose_source(options.source, sources);
  for (const ProbeSource& other : sources) {
    for (const std::string& option : other.options) {
      const bool read = std::find(source.options.begin(), source.options.end(), option) != source.options.end();
      if (!read && command.get_option(option).given())
        throw UsageError(fmt::format("{} serves {} only", option, other.name));
    }
  }
  check_output(options.output, common);
  const PointsTable table = read_points_csv(options.points);
  const ProbeEstimates estimates = source.probe({options.source, table, options.indirect_only, options.load, common});
  print_warnings(common, estimates.doubts);
  write_points_csv(options.output, common.force, table, estimates.e, estimates.standard_error);

  V3d mean(0, 0, 0);
  for (const Rgb& e : estimates.e) mean += V3d(e.x, e.y, e.z);
  mean /= static_cast<double>(estimates.e.size());
  nlohmann::ordered_json result{
      {"file", options.output}, {"points", table.p.size()}, {"mean_lux", {mean.x, mean.y, mean.z}}};
  result.update(to_json(estimates.facts));
  std::vector<std::string> warnings = estimates.warnings;
  warnings.insert(warnings.end(), estimates.doubts.begin(), estimates.doubts.end());
  result["warnings"] = warnings;
  print_result(common, result,
               fmt::format("{}: {} points, mean E {:.6g} {:.6g} {:.6g} lux\n", options.output, table.p.size(), mean.x,
                           mean.y, mean.z));
}

}  // namespace

void add_probe_command(Command app, CommonOptions& common) {
  Command command =
      app.add_subcommand("probe", "Irradiance at given points: from any asset, or path-traced from a scene");
  auto options = std::make_shared<ProbeOptions>();
  command
      .add_option("source", options->source,
                  "Grid (.vdb), cube map or DifMap (.exr), SH9 (.json), scene (.gltf, .glb) for path-traced\ntruth, "
                  "or environment map (.exr, .hdr ...) for the sum over its texels")
      .required()
      .type_name("SOURCE");
  command.add_option("--points", options->points, "Points: columns x,y,z (metres) and nx,ny,nz")
      .required()
      .type_name("P.csv");
  command
      .add_option("-o,--output", options->output,
                  "P's columns and r,g,b (lux), r_se,g_se,b_se (standard errors; a grid's are of its\nphotons' noise "
                  "alone, estimated a quarter too large as a rule, and 95 % bounds where no photon\n"
                  "came; empty where no path of a scene's met light)")
      .required()
      .type_name("OUT.csv");
  command.add_flag("--indirect-only", options->indirect_only, "Leave out light straight from its sources");

  auto sources = std::make_shared<std::vector<ProbeSource>>();
  sources->push_back(make_grid_source(command));
  sources->push_back(make_cubemap_source(command));
  sources->push_back(make_sh9_source());
  sources->push_back(make_difmap_source());
  sources->push_back(make_scene_source(command));
  sources->push_back(make_fiv_source(command));
  sources->push_back(make_environment_source());
  const std::vector<std::string> scene_options = add_scene_options(command, options->load, "For scenes");
  for (ProbeSource& source : *sources) {
    if (source.reads_scenes) source.options.insert(source.options.end(), scene_options.begin(), scene_options.end());
  }
  command.footer(
      "Examples:\n"
      "  ivory probe room.vdb --points p.csv -o grid.csv --scene room.glb\n"
      "  ivory probe sky.hdr --points p.csv -o exact.csv\n"
      "  ivory probe room.glb --points p.csv -o truth.csv --indirect-only --samples 64k");
  set_action(command, common, Output::file,
             [options, sources, command, &common] { run_probe(*options, *sources, command, common); });
}

}  // namespace ivory
