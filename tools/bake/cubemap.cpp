// ivory bake cubemap: what arrives at a point, as a localized cube map.
#include "grid/io/cubemap.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/cubemap/captured.h"
#include "grid/io/json.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/assumptions.h"
#include "tools/input/grid.h"
#include "tools/input/scene.h"
#include "tracer/bake/cubemap/capture.h"

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
};

// Refuses maps that nothing can be lit by, and says what looks like a mistake.
std::vector<std::string> judge(const BakeCubemapOptions& options, const Capture& capture, const Scene& scene) {
  const std::string at = fmt::format("({}, {}, {})", options.at.x, options.at.y, options.at.z);
  const bool dark = std::all_of(capture.cube.radiance.texels.begin(), capture.cube.radiance.texels.end(), is_black);
  if (capture.sky_share > 0.999999 && !scene.environment)
    throw Error(options.scene, "has nothing to be seen from " + at, "choose --at within the scene, or give --env");
  const bool backs = capture.back_share > 0.5 * (1 - capture.sky_share);
  if (backs && dark)
    throw Error(
        options.scene,
        at + " lies inside a wall or outside of the scene: only backs of surfaces and no light are seen from there",
        "choose --at in the open");
  std::vector<std::string> warnings;
  if (backs) {
    warnings.push_back(
        fmt::format("{:.0f} % of what is seen from {} are backs of single-sided surfaces: it may lie inside a wall",
                    100 * capture.back_share, at));
  } else if (dark) {
    warnings.push_back("no light arrives at " + at + ": the cube map is black");
  }
  if (!bounds(scene).intersects(to_local(options.at, scene.anchor_m)))
    warnings.push_back(at + " lies outside of the scene's bounds");
  return warnings;
}

void run_bake_cubemap(const BakeCubemapOptions& options, const CommonOptions& common) {
  if (options.capture % options.size != 0)
    throw UsageError(fmt::format("--size {} does not divide --capture {}", options.size, options.capture));
  check_output(options.output, ".exr", common);
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
  if (!options.grid->grid.empty()) {
    grid = load_grid(*options.grid, input, common);
    light = {&*grid, options.grid->lookup};
    params.grid = &light;
  }
  const auto start = std::chrono::steady_clock::now();
  const Capture capture = [&] {
    Progress progress(common, "capturing", "samples");
    const std::uint64_t total = std::uint64_t(6) * options.capture * options.capture * options.samples;
    params.progress = [&](double fraction) { progress.update(std::uint64_t(fraction * double(total)), total); };
    return capture_cube(input.lit, to_local(options.at, input.lit.scene->anchor_m), params);
  }();
  const std::vector<std::string> warnings = judge(options, capture, *input.lit.scene);
  print_warnings(common, warnings);
  LocalizedCube cube = localize(capture.cube, options.size, options.shell);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  Metadata& m = cube.metadata = input.origin;
  m["version"] = std::string(IVORY_VERSION);
  m["method"] = std::string("localized cube map");
  m["indirect"] = std::string(grid ? "grid" : "path");
  if (grid) describe(*options.grid, m);
  m["capture_size"] = std::int64_t(options.capture);
  m["samples"] = std::int64_t(options.samples);
  m["seed"] = std::int64_t(options.seed);
  m["shell"] = std::string(name_of(options.shell));
  m["units"] = std::string("nits, 1/m");
  keep_assumptions(m, warnings);
  write_localized_cube(options.output, cube, common.force);

  double nearest = 0;
  V3d mean(0, 0, 0);
  for (const float inverse : capture.cube.inverse_distance) nearest = std::max(nearest, double(inverse));
  for (std::size_t i = 0; i < cube.radiance.texels.size(); ++i) {
    const int size = options.size;
    const int in_face = int(i % (std::size_t(size) * std::size_t(size)));
    const Rgb& radiance = cube.radiance.texels[i];
    mean += V3d(radiance.x, radiance.y, radiance.z) *
            (cube_texel_solid_angle(size, in_face / size, in_face % size) / (4 * double(pi)));
  }
  nlohmann::ordered_json result;
  result["output"] = options.output;
  result["position_m"] = {options.at.x, options.at.y, options.at.z};
  result["size"] = options.size;
  result.update(to_json(cube.metadata));
  result["mean_radiance_nits"] = {mean.x, mean.y, mean.z};
  result["nearest_m"] = nearest > 0 ? 1 / nearest : 0.0;
  result["sky_share"] = capture.sky_share;
  result["seconds"] = seconds;
  std::vector<std::string> all = input.warnings;
  all.insert(all.end(), warnings.begin(), warnings.end());
  result["warnings"] = all;
  std::string human =
      fmt::format("{}: 6x{}x{} texels from 6x{}x{}, mean {:.4g} {:.4g} {:.4g} nits, {:.2f} s\n", options.output,
                  options.size, options.size, options.capture, options.capture, mean.x, mean.y, mean.z, seconds);
  human += nearest > 0 ? fmt::format("nearest surface {:.4g} m, sky {:.1f} %\n", 1 / nearest, 100 * capture.sky_share)
                       : "only sky is seen\n";
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
  command.add_option("--capture", options->capture, "Texels along an edge while capturing").within(1, 4096);
  command.add_count("--samples", options->samples, 1, 1'000'000, "Paths a captured texel");
  command.add_count("--seed", options->seed, "Seed of the random numbers");
  add_environment_options(command, options->environment);
  add_scene_options(command, options->load);
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
  set_action(command, common, Output::file, [options, &common] { run_bake_cubemap(*options, common); });
}

}  // namespace ivory
