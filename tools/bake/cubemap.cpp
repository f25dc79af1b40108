// ivory bake cubemap: what arrives at a point, as a localized cube map.
#include "grid/io/cubemap.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/anchor.h"
#include "grid/base/cheapest.h"
#include "grid/base/error.h"
#include "grid/cubemap/captured.h"
#include "grid/io/json.h"
#include "tools/bake/asset_contract.h"
#include "tools/bake/checkpoint.h"
#include "tools/bake/facts.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/assumptions.h"
#include "tools/input/grid.h"
#include "tools/input/scene.h"
#include "tracer/bake/cubemap/capture.h"
#include "tracer/bake/cubemap/truth.h"

namespace ivory {

namespace {

struct BakeCubemapOptions {
  std::string scene;
  std::string output;
  SceneOptions load;
  EnvironmentChoice environment;
  ShellFit shell = ShellFit::fitted;
  V3d at{0, 0, 0};
  int size = 4;
  int capture = CaptureParams{}.size;
  int samples = CaptureParams{}.samples;
  std::uint64_t seed = 1;
  std::shared_ptr<GridInputOptions> grid;
  AssetContract contract;
};

// Receivers that the size is chosen at, and others that the result is judged at.
constexpr int pilot_receivers = 1500;
constexpr int certificate_receivers = 3000;
constexpr std::uint64_t pilot_seed = 1;
constexpr std::uint64_t certificate_seed = 2;

// Paths of an estimate of E. Its noise, of some 10 % of E at 128, is squared and averaged over the receivers, and is to
// stay well below the square of the error.
int truth_paths(const AssetContract& contract) {
  int paths = 128;
  for (double target = contract.target.value_or(0.05); target < 0.05 && paths < 1024; target *= 1.41) paths *= 2;
  return paths;
}

// Sizes that divide the capture's, up to `most`.
std::vector<int> possible_sizes(int capture, int most) {
  std::vector<int> sizes;
  for (int size = 1; size <= most; ++size) {
    if (capture % size == 0) sizes.push_back(size);
  }
  return sizes;
}

BakePlan make_plan(const CheapestSetting& setting, double seconds, double truth_seconds) {
  BakePlan plan;
  plan.knobs["size"] = setting.value;
  plan.seconds = within_factor(seconds + truth_seconds * certificate_receivers / pilot_receivers, 1.6);
  const double texels = 6.0 * setting.value * setting.value;
  plan.memory_bytes = within_factor(peak_memory_bytes(), 1.3);
  plan.file_bytes = {0.5 * texels * 28 + 1024, 0.9 * texels * 28 + 2048, texels * 28 + 8192};
  plan.error = predicted_error(setting.predicted);
  return plan;
}

void run_bake_cubemap(const BakeCubemapOptions& options, const Command& command, const CommonOptions& common) {
  const AssetContract& contract = options.contract;
  if (!contract.target && options.capture % options.size != 0)
    throw UsageError(fmt::format("--size {} does not divide --capture {}", options.size, options.capture));
  check_output(options.output, ".exr", contract, common);
  const auto input = load_scene_input(options.scene, options.load, options.environment, common);
  if (input.lit.lights.empty())
    throw Error(options.scene, "nothing emits light", "add a light or an emissive material, or give --env");

  CaptureParams params;
  params.size = options.capture;
  params.samples = options.samples;
  params.seed = options.seed;
  params.threads = thread_count(common);
  std::optional<IrradianceGrid> grid;
  GridLight light;
  LookupTally tally;
  if (!options.grid->grid.empty()) {
    grid = load_grid(*options.grid, input, common);
    light = {&*grid, options.grid->lookup, &tally};
    params.grid = &light;
  }
  const auto start = std::chrono::steady_clock::now();
  const Capture capture = [&] {
    Progress progress(common, "capturing", "samples");
    const std::uint64_t total = std::uint64_t(6) * options.capture * options.capture * options.samples;
    params.progress = [&](double fraction) { progress.update(std::uint64_t(fraction * double(total)), total); };
    return capture_cube(input.lit, to_local(options.at, input.lit.scene->anchor_m), params);
  }();
  std::vector<std::string> warnings = judge_capture(options.scene, options.at, capture, *input.lit.scene);
  const std::vector<std::string> doubts = doubts_about(tally, *options.grid);
  warnings.insert(warnings.end(), doubts.begin(), doubts.end());
  print_warnings(common, warnings);
  const auto seconds_since = [](std::chrono::steady_clock::time_point from) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
  };
  const auto trace_truth = [&](int receivers, std::uint64_t seed) {
    return trace_cube_truth(input.lit, capture.cube.origin_m, {receivers, truth_paths(contract), seed});
  };
  int size = options.size;
  if (contract.target || contract.dry_run) {
    const auto before = std::chrono::steady_clock::now();
    const CubeTruth pilot = trace_truth(pilot_receivers, pilot_seed);
    const double truth_seconds = seconds_since(before);
    const int most = command.get_option("--size").given() ? options.size : largest_localized_size;
    const std::vector<int> sizes = contract.target ? possible_sizes(options.capture, most) : std::vector<int>{size};
    const CheapestSetting setting = cheapest_setting(sizes, 0, contract.target.value_or(1), [&](int m) {
      return cube_error(localize(capture.cube, m, options.shell), pilot);
    });
    size = setting.value;
    if (contract.dry_run) {
      std::vector<std::string> all = input.warnings;
      all.insert(all.end(), warnings.begin(), warnings.end());
      print_plan(options.output, make_plan(setting, seconds_since(start), truth_seconds), contract, all, common);
      return;
    }
  }
  LocalizedCube cube = localize(capture.cube, size, options.shell);
  const double seconds = seconds_since(start);

  Metadata& m = cube.metadata = cubemap_facts(input.origin, params, options.shell, warnings);
  if (grid) {
    describe(*options.grid, m);
    describe(tally, m);
  }
  std::optional<Certificate> certificate;
  if (contract.measures()) {
    const CubeTruth truth = trace_truth(certificate_receivers, certificate_seed);
    certificate = make_certificate(
        cube_error(cube, truth), contract,
        fmt::format("E but for punctual lights at {} points of any normal between the reference point and what is seen "
                    "from it, {:.3g} m around at most, path-traced; RMS ÷ mean E; {} more points right before lamps, "
                    "above {:g} times the mean E, left out",
                    truth.receivers.size(), truth.reach_m, truth.dazzled, most_of_mean));
    keep_certificate(*certificate, m);
  }
  write_localized_cube(options.output, cube, common.force);

  double nearest = 0;
  V3d mean(0, 0, 0);
  for (const float inverse : capture.cube.inverse_distance) nearest = std::max(nearest, double(inverse));
  for (std::size_t i = 0; i < cube.radiance.texels.size(); ++i) {
    const int in_face = int(i % (std::size_t(size) * std::size_t(size)));
    const Rgb& radiance = cube.radiance.texels[i];
    mean += V3d(radiance.x, radiance.y, radiance.z) *
            (cube_texel_solid_angle(size, in_face / size, in_face % size) / (4 * double(pi)));
  }
  nlohmann::ordered_json result;
  result["output"] = options.output;
  result["position_m"] = {options.at.x, options.at.y, options.at.z};
  result["size"] = size;
  result.update(to_json(cube.metadata));
  result["mean_radiance_nits"] = {mean.x, mean.y, mean.z};
  result["nearest_m"] = nearest > 0 ? 1 / nearest : 0.0;
  result["sky_share"] = capture.sky_share;
  result["seconds"] = seconds;
  std::vector<std::string> all = input.warnings;
  all.insert(all.end(), warnings.begin(), warnings.end());
  std::string human =
      fmt::format("{}: 6x{}x{} texels from 6x{}x{}, mean {:.4g} {:.4g} {:.4g} nits, {:.2f} s\n", options.output, size,
                  size, options.capture, options.capture, mean.x, mean.y, mean.z, seconds);
  human += nearest > 0 ? fmt::format("nearest surface {:.4g} m, sky {:.1f} %\n", 1 / nearest, 100 * capture.sky_share)
                       : "only sky is seen\n";
  if (certificate) report_certificate(*certificate, result, human, all, common);
  result["warnings"] = all;
  print_result(common, result, human);
}

}  // namespace

void add_bake_cubemap_command(Command bake, CommonOptions& common) {
  Command command = bake.add_subcommand(
      "cubemap", "Bake what arrives at a point into a localized cube map (.exr), to light objects that move near it");
  auto options = std::make_shared<BakeCubemapOptions>();
  command.add_option("scene", options->scene, "Scene: .gltf or .glb, metres, +Y up").required().type_name("SCENE");
  command.add_option("-o,--output", options->output, "Cube map to write, .exr").required().type_name("OUT.exr");
  command
      .add_option(
          "--at", [options](const std::string& text) { options->at = parse_vector3("--at", text); },
          "The reference point in metres")
      .required()
      .type_name("X,Y,Z");
  command.add_option("--size", options->size, "Texels along an edge of the six faces; divides --capture")
      .within(1, largest_localized_size);
  add_contract_options(command, options->contract,
                       "Error of E around the reference point to be reached, RMS ÷ mean E, as 2% or 0.02",
                       "the fewest texels that do are baked, of at most --size along an edge where that is given");
  command.add_option("--capture", options->capture, "Texels along an edge while capturing").within(1, 4096);
  command.add_count("--samples", options->samples, 1, 1'000'000, "Paths a captured texel");
  command.add_count("--seed", options->seed, "Seed of the random numbers");
  add_environment_options(command, options->environment);
  add_scene_options(command, options->load);
  add_portable_option(command, options->load);
  options->grid = add_grid_options(command, "Baked grid that indirect light is read from [path traced]");
  command.add_choice("--shell", options->shell,
                     "How corners of texels are placed: by least squares over all distances, at the distance\n"
                     "right there, or at the mean distance around");
  command.footer(
      "All light that arrives is captured, straight from emissive surfaces and the sky too, but not that of\n"
      "point, spot and directional lights, which are sampled when rendering.\n"
      "The same command gives the same bytes with any --threads.\n"
      "\nExamples:\n"
      "  ivory bake cubemap room.glb --at 0,1,0 -o room.exr\n"
      "  ivory render room.glb --method cubemap --cubemap room.exr --object ball.glb@0.5,1,0 -o picture.exr");
  refuse_checkpoint_option(command);
  set_action(command, common, Output::file,
             [options, command, &common] { run_bake_cubemap(*options, command, common); });
}

}  // namespace ivory
