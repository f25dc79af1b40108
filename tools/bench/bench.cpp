// ivory bench: rates beside their bounds, as ratios measured in one run.
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/field/resolve.h"
#include "tools/bench/all.h"
#include "tools/bench/measure_lookup.h"
#include "tools/bench/measure_tracer.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/scene.h"
#include "tracer/bake/field/baker.h"

namespace ivory {
namespace {

struct BenchOptions {
  std::vector<std::string> scenes;
  SceneOptions load;
  std::string resolution = "32,32,32";
  std::uint64_t photons = 400'000;
  int rounds = 5;
  std::uint64_t triangles = 250'000;
};

nlohmann::ordered_json to_json(const std::string& scene, const TracerBench& bench) {
  nlohmann::ordered_json deposits = nlohmann::ordered_json::array();
  for (const DepositFigure& d : bench.deposits) {
    deposits.push_back({{"method", d.name},
                        {"segments_per_s", d.segments_per_s},
                        {"relative_variance", d.relative_variance},
                        {"variance_time_over_free", d.variance_time}});
  }
  return {{"scene", scene},
          {"triangles", bench.triangles},
          {"segments_per_s", bench.segments_per_s},
          {"embree_rays_per_s", bench.embree_rays_per_s},
          {"embree_ratio", bench.embree_ratio},
          {"undeposited_ratio", bench.undeposited_ratio},
          {"two_thread_speed_up", bench.two_thread_speed_up},
          {"deposits", deposits}};
}

std::string to_text(const std::string& scene, const TracerBench& bench) {
  std::string text = fmt::format(
      "{} ({} triangles)\n"
      "  photon segments traced and deposited  {}/s\n"
      "  Embree closest hit on the same rays   {}/s\n"
      "  ratio {:.2f} (without deposit {:.2f}), two threads over one {:.2f}\n",
      scene, bench.triangles, format_count(bench.segments_per_s), format_count(bench.embree_rays_per_s),
      bench.embree_ratio, bench.undeposited_ratio, bench.two_thread_speed_up);
  for (const DepositFigure& d : bench.deposits) {
    text += fmt::format("  {:<15} {:>8}/s, variance x time {:.2f} of a free deposit\n", d.name,
                        format_count(d.segments_per_s), d.variance_time);
  }
  return text;
}

void run(const BenchOptions& options, const CommonOptions& common) {
  TracerBenchParams params;
  params.resolution = parse_size3("--resolution", options.resolution, 2);
  params.photons = options.photons;
  params.rounds = options.rounds;
  params.threads = thread_count(common);

  std::vector<Scene> scenes;
  for (const std::string& path : options.scenes) scenes.push_back(load_scene(path, options.load.load).scene);
  scenes.push_back(make_bench_scene(options.triangles));

  nlohmann::ordered_json results = nlohmann::ordered_json::array();
  std::string text;
  for (Scene& scene : scenes) {
    const LitScene lit = make_lit_scene(std::move(scene));
    const TracerBench bench = bench_tracer(lit, params);
    results.push_back(to_json(lit.scene->name, bench));
    text += to_text(lit.scene->name, bench);
  }
  print_result(common, {{"threads", params.threads}, {"scenes", results}}, text);
}

struct LookupBenchOptions {
  std::string scene;
  SceneOptions load;
  std::string resolution = "32,32,32";
  std::uint64_t photons = 1'000'000;
  int levels = 1;
  bool tricubic = false;
};

void run_lookup(const LookupBenchOptions& options, const CommonOptions& common) {
  const LitScene lit = make_lit_scene(load_scene(options.scene, options.load.load).scene);
  GridBakeParams bake;
  bake.resolution = parse_size3("--resolution", options.resolution, 2);
  bake.photons = options.photons;
  bake.levels = options.levels;
  bake.threads = thread_count(common);
  const IrradianceGrid grid = resolve(bake_grid_sums(lit, bake));
  LookupParams lookup;
  if (options.tricubic) lookup.interpolation = Interpolation::tricubic;
  const LookupBench bench = bench_lookup(grid, lit.intersector, lookup);
  const auto line = [](const char* guard, const LookupFigure& figure) {
    return fmt::format("  {:<21} {:>5.0f} ns one by one, {:>5.0f} ns batched\n", guard, figure.single_ns,
                       figure.batched_ns);
  };
  print_result(
      common,
      {{"scene", lit.scene->name},
       {"lookup_off_ns", bench.off.single_ns},
       {"lookup_planes_ns", bench.planes.single_ns},
       {"lookup_rays_ns", bench.rays.single_ns},
       {"batched_off_ns", bench.off.batched_ns},
       {"batched_planes_ns", bench.planes.batched_ns},
       {"batched_rays_ns", bench.rays.batched_ns},
       {"occlusion_ray_ns", bench.occlusion_ray_ns}},
      fmt::format("{}: a look-up takes, on one thread\n{}{}{}  one short occlusion ray {:.0f} ns\n", lit.scene->name,
                  line("without guard", bench.off), line("by the stored planes", bench.planes),
                  line("by rays", bench.rays), bench.occlusion_ray_ns));
}

void add_lookup_bench(Command bench, CommonOptions& common) {
  Command command = bench.add_subcommand(
      "lookup",
      "Time of one grid look-up (spatial and directional interpolation) on one thread, with each leak guard, one by\n"
      "one and many at once.");
  auto options = std::make_shared<LookupBenchOptions>();
  command.add_option("SCENE", options->scene, "glTF file to bake and look up").required();
  command.add_option("--resolution", options->resolution, "Grid vertices");
  command.add_count("--photons", options->photons, "Photons of the bake");
  add_scene_options(command, options->load);
  command.add_flag("--tricubic", options->tricubic, "Tricubic instead of trilinear");
  command.add_count("--levels", options->levels, 1, max_levels, "Levels of spacing, as of ivory bake grid");
  command.footer("Example:\n  ivory bench lookup scenes/cornell_box.gltf");
  set_action(command, common, Output::none, [options, &common] { run_lookup(*options, common); });
}

}  // namespace

void add_bench_command(Command app, CommonOptions& common) {
  Command bench = app.add_subcommand("bench", "Measure rates beside their bounds");
  bench.require_subcommand();
  Command tracer = bench.add_subcommand(
      "tracer",
      "Photon segments per second beside Embree's closest-hit rate on the very same rays, and variance\n"
      "times time of each way to deposit them.");
  auto options = std::make_shared<BenchOptions>();
  tracer.add_option("SCENES", options->scenes, "glTF files to measure beside the built-in large mesh");
  tracer.add_option("--resolution", options->resolution, "Grid vertices");
  tracer.add_count("--photons", options->photons, "Photons a measurement");
  tracer.add_count("--rounds", options->rounds, 1, 1000, "Measurements in turn; medians are reported");
  tracer.add_count("--triangles", options->triangles, "Triangles of the built-in mesh");
  add_scene_options(tracer, options->load);
  tracer.footer("Example:\n  ivory bench tracer scenes/cornell_box.gltf --json");
  set_action(tracer, common, Output::none, [options, &common] { run(*options, common); });
  add_lookup_bench(bench, common);
  add_bench_all_command(bench, common);
  add_bench_cubemap_command(bench, common);
  add_bench_sh9_command(bench, common);
  add_bench_fiv_command(bench, common);
  add_bench_runtime_command(bench, common);
  add_bench_stability_command(bench, common);
  add_bench_gaussians_command(bench, common);
}

}  // namespace ivory
