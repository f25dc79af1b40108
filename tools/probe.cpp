// ivory probe: irradiance at given points, from a grid or path-traced from a scene.
#include "tracer/probe.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>

#include "grid/error.h"
#include "grid/io_vdb.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/points_csv.h"
#include "tools/scene_input.h"
#include "tracer/guard_rays.h"

namespace ivory {

namespace {

struct ProbeOptions {
  std::string source;
  std::string points;
  std::string output;
  bool indirect_only = false;
  // Grids only.
  std::string scene;
  std::string guard;
  std::string interpolation = "trilinear";
  std::string reconstruction = "optimal";
  float nudge_voxels = LookupParams{}.nudge_voxels;
  // Scenes only.
  std::string environment;
  std::uint64_t samples = 1024;
  std::uint64_t seed = 1;
  int bounces = ProbeParams{}.max_bounces;
};

struct Estimates {
  std::vector<Rgb> e;
  std::vector<Rgb> standard_error;
  Metadata facts;
};

// The guard asked for, or the best that the inputs allow.
Guard choose_guard(const ProbeOptions& options, const IrradianceGrid& grid) {
  if (options.guard.empty()) {
    if (!options.scene.empty()) return Guard::rays;
    return grid.guard.empty() ? Guard::off : Guard::planes;
  }
  const Guard guard = guard_from_name(options.guard);
  if (guard == Guard::rays && options.scene.empty()) throw UsageError("--guard rays needs the scene: give --scene");
  if (guard != Guard::rays && !options.scene.empty()) throw UsageError("--scene serves --guard rays only");
  if (guard == Guard::planes && grid.guard.empty())
    throw Error(options.source, "stores no compact guard", "bake it with --guard planes or rays, or give --guard off");
  return guard;
}

Estimates probe_grid(const ProbeOptions& options, const PointsTable& table, const CommonOptions& common) {
  const IrradianceGrid grid = read_grid_vdb(options.source);
  const Guard guard = choose_guard(options, grid);
  LookupParams params;
  params.interpolation = options.interpolation == "tricubic" ? Interpolation::tricubic : Interpolation::trilinear;
  params.reconstruction = reconstruction_from_name(options.reconstruction);
  params.nudge_voxels = options.nudge_voxels;
  if (params.reconstruction == Reconstruction::paper && grid.basis != Basis::vectors) {
    throw UsageError(fmt::format("--reconstruction paper reads basis 'vectors' only; {} stores '{}'", options.source,
                                 name(grid.basis)));
  }
  const auto light = grid.metadata.find("light");
  if (options.indirect_only && light != grid.metadata.end() && light->second != MetaValue(std::string("indirect")))
    throw Error(options.source, "was baked with --direct and cannot be read without", "bake it again without --direct");

  std::unique_ptr<SceneInput> scene;
  if (!options.scene.empty()) {
    scene = load_scene_input(options.scene, {}, common);
    const auto baked = grid.metadata.find("scene_hash");
    if (baked != grid.metadata.end() && baked->second != scene->origin.at("scene_hash"))
      print_note(common, "warning: " + options.scene + " has changed since " + options.source + " was baked");
  }
  const Intersector* intersector = scene ? scene->intersector.get() : nullptr;

  Estimates out;
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
      {"source", std::string("grid")}, {"guard", std::string(name(guard))}, {"outside", std::int64_t(outside)}};
  return out;
}

Estimates probe_path_traced(const ProbeOptions& options, const PointsTable& table, const CommonOptions& common) {
  const auto input = load_scene_input(options.source, options.environment, common);
  std::vector<ProbePoint> points;
  for (std::size_t i = 0; i < table.p.size(); ++i) points.push_back({table.p[i], table.n[i]});
  ProbeParams params;
  params.samples = static_cast<int>(options.samples);
  params.max_bounces = options.bounces;
  params.seed = options.seed;
  params.threads = thread_count(common);
  params.indirect_only = options.indirect_only;
  Progress progress(common, "probing", "paths");
  const std::uint64_t paths = points.size() * options.samples;
  params.progress = [&](double fraction) {
    progress.update(static_cast<std::uint64_t>(fraction * static_cast<double>(paths)), paths);
  };
  Estimates out;
  for (const ProbeResult& result : probe_scene(input->scene, *input->intersector, *input->lights, points, params)) {
    out.e.push_back(result.e);
    out.standard_error.push_back(result.standard_error);
  }
  out.facts = {{"source", std::string("scene")},
               {"samples", std::int64_t(options.samples)},
               {"seed", std::int64_t(options.seed)}};
  return out;
}

void run_probe(const ProbeOptions& options, const CLI::App& command, const CommonOptions& common) {
  const bool is_scene = is_scene_name(options.source);
  const auto refuse_given = [&](std::initializer_list<const char*> names, const char* purpose) {
    for (const char* option : names) {
      if (command.count(option) > 0) throw UsageError(fmt::format("{} serves {} only", option, purpose));
    }
  };
  if (is_scene) {
    refuse_given({"--scene", "--guard", "--interpolation", "--reconstruction", "--nudge"}, "grids");
  } else {
    refuse_given({"--env", "--samples", "--seed", "--bounces"}, "scenes");
  }
  check_output(options.output, common);
  const PointsTable table = read_points_csv(options.points);
  const Estimates estimates = is_scene ? probe_path_traced(options, table, common) : probe_grid(options, table, common);
  write_points_csv(options.output, common.force, table, estimates.e, estimates.standard_error);

  V3d mean(0, 0, 0);
  for (const Rgb& e : estimates.e) mean += V3d(e.x, e.y, e.z);
  mean /= static_cast<double>(estimates.e.size());
  nlohmann::ordered_json result{
      {"file", options.output}, {"points", table.p.size()}, {"mean_lux", {mean.x, mean.y, mean.z}}};
  for (const auto& [key, value] : estimates.facts)
    std::visit([&, &fact = key](const auto& v) { result[fact] = v; }, value);
  print_result(common, result,
               fmt::format("{}: {} points, mean E {:.6g} {:.6g} {:.6g} lux\n", options.output, table.p.size(), mean.x,
                           mean.y, mean.z));
}

}  // namespace

void add_probe_command(CLI::App& app, CommonOptions& common) {
  auto* command = app.add_subcommand("probe", "Irradiance at given points: from a grid, or path-traced from a scene");
  auto options = std::make_shared<ProbeOptions>();
  command->add_option("source", options->source, "Grid (.vdb), or scene (.gltf, .glb) for path-traced truth")
      ->required()
      ->type_name("SOURCE");
  command->add_option("--points", options->points, "Points: columns x,y,z (metres) and nx,ny,nz")
      ->required()
      ->type_name("P.csv");
  command->add_option("-o,--output", options->output, "P's columns and r,g,b (lux), r_se,g_se,b_se (standard errors)")
      ->required()
      ->type_name("OUT.csv");
  command->add_flag("--indirect-only", options->indirect_only, "Leave out light straight from its sources");

  const std::string grids = "For grids";
  command->add_option("--scene", options->scene, "The scene that was baked, for --guard rays")
      ->type_name("SCENE")
      ->group(grids);
  command
      ->add_option("--guard", options->guard,
                   "What keeps leaks out: rays [with --scene], the stored planes\n[where there are any], off")
      ->check(CLI::IsMember({"rays", "planes", "off"}))
      ->group(grids);
  command->add_option("--interpolation", options->interpolation, "Between vertices")
      ->check(CLI::IsMember({"trilinear", "tricubic"}))
      ->capture_default_str()
      ->group(grids);
  command->add_option("--reconstruction", options->reconstruction, "From stored moments to E(n)")
      ->check(CLI::IsMember({"optimal", "paper"}))
      ->capture_default_str()
      ->group(grids);
  command->add_option("--nudge", options->nudge_voxels, "Points move this far along n first, in voxels")
      ->check(CLI::Range(0.0, 2.0))
      ->capture_default_str()
      ->group(grids);

  const std::string scenes = "For scenes";
  command
      ->add_option("--env", options->environment,
                   "Lat-long environment map in nits: .exr or .hdr, 2:1; +Z in the middle, +Y up")
      ->type_name("IMAGE")
      ->group(scenes);
  command
      ->add_option_function<std::string>(
          "--samples",
          [options](const std::string& text) {
            options->samples = parse_count("--samples", text);
            if (options->samples < 2 || options->samples > 2'000'000'000)
              throw UsageError("--samples must lie between 2 and 2g");
          },
          "Paths a point; k, m, g are allowed")
      ->default_str("1024")
      ->type_name("COUNT")
      ->group(scenes);
  add_count_option(*command, "--seed", options->seed, "Seed of the random numbers")->group(scenes);
  command->add_option("--bounces", options->bounces, "Surfaces a path may scatter at")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str()
      ->group(scenes);
  command->footer(
      "Examples:\n"
      "  ivory probe room.vdb --points p.csv -o grid.csv --scene room.glb\n"
      "  ivory probe room.glb --points p.csv -o truth.csv --indirect-only --samples 64k");
  set_action(*command, common, Output::file, [options, command, &common] { run_probe(*options, *command, common); });
}

}  // namespace ivory
