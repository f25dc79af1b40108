// ivory render: a picture by path tracing, from a grid, or by final gather over a grid.
#include <algorithm>
#include <chrono>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/error.h"
#include "grid/io_vdb.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/scene_input.h"
#include "tracer/final_gather.h"
#include "tracer/image_io.h"
#include "tracer/path_tracer.h"

namespace ivory {

namespace {

struct RenderOptions {
  std::string scene;
  std::vector<std::string> outputs;  // one picture in several formats
  std::string method = "path";
  std::string grid;
  std::string environment;
  std::string camera;
  std::string guard = "rays";
  std::string interpolation = "trilinear";
  std::string reconstruction = "optimal";
  std::uint64_t samples = 64;
  std::uint64_t gather = 16;
  std::uint64_t max_bounces = 1000;
  std::uint64_t seed = 1;
  Imath::V2i size{640, 480};
  std::optional<float> exposure_stops;
  bool indirect_only = false;

  bool uses_grid() const { return method != "path"; }
};

int int_count(const char* option, std::uint64_t count, std::uint64_t least) {
  if (count < least || count > std::uint64_t(std::numeric_limits<int>::max()))
    throw UsageError(fmt::format("{}: {} is not from {} to {}", option, count, least, std::numeric_limits<int>::max()));
  return int(count);
}

// A grid that final gather can add direct light to, and that has what the guard needs.
IrradianceGrid load_grid(const RenderOptions& options, const SceneInput& input, const CommonOptions& common) {
  IrradianceGrid grid = read_grid_vdb(options.grid);
  const auto text = [&](const char* key) {
    const auto found = grid.metadata.find(key);
    const auto* value = found == grid.metadata.end() ? nullptr : std::get_if<std::string>(&found->second);
    return value == nullptr ? std::string() : *value;
  };
  if (text("light") == "direct and indirect")
    throw Error(options.grid, "holds direct light, which rendering would count twice", "bake it without --direct");
  if (options.guard == "planes" && grid.guard.empty())
    throw Error(options.grid, "stores no guard planes", "bake it with --guard planes, or render with --guard rays");
  if (!text("scene_hash").empty() && text("scene_hash") != input.scene.content_hash)
    print_note(common, fmt::format("note: {} was baked from another scene ({})", options.grid, text("scene")));
  if (options.reconstruction == "paper" && grid.basis != Basis::vectors)
    throw UsageError(
        fmt::format("--reconstruction paper needs a grid of basis vectors, {} has {}", options.grid, name(grid.basis)));
  return grid;
}

View choose_view(const RenderOptions& options, const Scene& scene, const Intersector& intersector) {
  const int width = options.size.x;
  const int height = options.size.y;
  if (!options.camera.empty()) return make_view(options.scene, find_camera(scene, options.camera), width, height);
  if (!scene.cameras.empty()) return make_view(options.scene, scene.cameras.front(), width, height);
  const Camera framing = framing_camera(intersector.center(), intersector.radius_m(), float(width) / float(height));
  return make_view(options.scene, framing, width, height);
}

Film render(const RenderOptions& options, const SceneInput& input, const CommonOptions& common) {
  const Intersector& intersector = *input.intersector;
  const Lights& lights = *input.lights;
  const View view = choose_view(options, input.scene, intersector);
  if (lights.empty()) print_note(common, fmt::format("warning: nothing in {} emits light", options.scene));

  RenderParams params;
  params.samples = int_count("--samples", options.samples, 1);
  params.seed = options.seed;
  params.threads = thread_count(common);
  std::optional<IrradianceGrid> grid;
  if (options.uses_grid()) grid = load_grid(options, input, common);

  Progress progress(common, "rendering", "samples");
  const std::uint64_t total = options.samples * std::uint64_t(view.width) * std::uint64_t(view.height);
  params.progress = [&](double fraction) { progress.update(std::uint64_t(fraction * double(total)), total); };
  if (!grid) {
    PathParams path;
    path.max_bounces = int_count("--max-bounces", options.max_bounces, 0);
    path.indirect_only = options.indirect_only;
    return render_path(intersector, lights, view, params, path);
  }
  GridLight light;
  light.grid = &*grid;
  light.guard = guard_from_name(options.guard);
  light.lookup.interpolation = options.interpolation == "tricubic" ? Interpolation::tricubic : Interpolation::trilinear;
  light.lookup.reconstruction = reconstruction_from_name(options.reconstruction);
  GatherParams gather;
  gather.gather_rays = options.method == "gather" ? int_count("--gather", options.gather, 1) : 0;
  gather.indirect_only = options.indirect_only;
  return render_gather(intersector, lights, light, view, params, gather);
}

Metadata describe(const RenderOptions& options, const SceneInput& input) {
  Metadata m = input.origin;
  m["version"] = std::string(IVORY_VERSION);
  m["method"] = options.method;
  m["samples"] = std::int64_t(options.samples);
  m["seed"] = std::int64_t(options.seed);
  m["light"] = std::string(options.indirect_only ? "indirect" : "all");
  m["units"] = std::string("nits");
  if (options.uses_grid()) {
    m["grid"] = options.grid.substr(options.grid.find_last_of('/') + 1);
    m["guard"] = options.guard;
    m["interpolation"] = options.interpolation;
    m["reconstruction"] = options.reconstruction;
    if (options.method == "gather") m["gather_rays"] = std::int64_t(options.gather);
  } else {
    m["max_bounces"] = std::int64_t(options.max_bounces);
  }
  return m;
}

// Scripts run one line with several methods, so options of another method are no error; but said.
void note_ignored(const CLI::App& command, const RenderOptions& options, const CommonOptions& common) {
  const auto note = [&](std::initializer_list<const char*> names, const char* methods) {
    for (const char* name : names) {
      if (command.get_option(name)->count() > 0)
        print_note(common, fmt::format("note: {} is ignored, it serves --method {}", name, methods));
    }
  };
  if (!options.uses_grid()) note({"--grid", "--guard", "--interpolation", "--reconstruction"}, "direct and gather");
  if (options.method != "gather") note({"--gather"}, "gather");
  if (options.method != "path") note({"--max-bounces"}, "path");
  if (options.exposure_stops && std::all_of(options.outputs.begin(), options.outputs.end(), is_linear_image))
    print_note(common, "note: --exposure is ignored, it serves tone-mapped pictures (.png, .jpg)");
}

void run_render(const RenderOptions& options, const CommonOptions& common) {
  if (options.uses_grid() && options.grid.empty())
    throw UsageError("--method " + options.method + " needs --grid GRID.vdb (see ivory bake grid)");
  for (const std::string& output : options.outputs) {
    check_output(output, common);
    check_image_name(output);
  }
  const auto input = load_scene_input(options.scene, options.environment, common);

  const auto start = std::chrono::steady_clock::now();
  const Film film = render(options, *input, common);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const Metadata metadata = describe(options, *input);
  const bool any_display = !std::all_of(options.outputs.begin(), options.outputs.end(), is_linear_image);
  const float exposure = options.exposure_stops.value_or(any_display ? auto_exposure(film) : 0);
  for (const std::string& output : options.outputs) {
    Metadata own = metadata;
    if (!is_linear_image(output)) own["exposure_stops"] = double(exposure);
    write_image(output, film, exposure, own, common.force);
  }

  double mean[3] = {0, 0, 0};
  for (const Rgb& pixel : film.pixels) {
    for (int c = 0; c < 3; ++c) mean[c] += double(pixel[c]) / double(film.pixels.size());
  }
  nlohmann::ordered_json result;
  result["output"] = options.outputs.front();
  result["outputs"] = options.outputs;
  result["width"] = film.width;
  result["height"] = film.height;
  for (const auto& [key, value] : metadata) std::visit([&, &k = key](const auto& v) { result[k] = v; }, value);
  if (any_display) result["exposure_stops"] = exposure;
  result["mean_radiance_nits"] = {mean[0], mean[1], mean[2]};
  result["seconds"] = seconds;
  result["warnings"] = input->warnings;
  std::string human = fmt::format("{}: {} x {}, {}, {} samples a pixel, mean {:.4g} {:.4g} {:.4g} nits, {:.2f} s\n",
                                  fmt::join(options.outputs, ", "), film.width, film.height, options.method,
                                  options.samples, mean[0], mean[1], mean[2], seconds);
  if (any_display) human += fmt::format("exposure {:+.2f} stops\n", exposure);
  print_result(common, result, human);
}

}  // namespace

void add_render_command(CLI::App& app, CommonOptions& common) {
  auto* command = app.add_subcommand("render", "Render a picture: path-traced, from a grid, or by final gather");
  auto options = std::make_shared<RenderOptions>();
  command->add_option("scene", options->scene, "Scene: .gltf or .glb, metres, +Y up")->required()->type_name("SCENE");
  command
      ->add_option("-o,--output", options->outputs,
                   "Picture to write: .exr, .hdr, .tif keep linear nits; .png, .jpg are tone-mapped; may be repeated")
      ->allow_extra_args(false)
      ->required()
      ->type_name("IMAGE");
  command
      ->add_option("--method", options->method,
                   "path: reference path tracer; direct: indirect light read from --grid; gather: final gather, one "
                   "bounce before --grid is read")
      ->check(CLI::IsMember({"path", "direct", "gather"}))
      ->capture_default_str();
  command->add_option("--grid", options->grid, "Baked grid of indirect light")->type_name("GRID.vdb");
  add_count_option(*command, "--samples", options->samples, "Samples a pixel");
  add_count_option(*command, "--gather", options->gather, "Rays a sample (gather)");
  add_count_option(*command, "--max-bounces", options->max_bounces,
                   "Surfaces that light may scatter at (path); Russian roulette ends most paths before");
  add_count_option(*command, "--seed", options->seed, "Seed of the random numbers");
  add_image_size_option(*command, "--size", options->size, "Size of the picture in pixels");
  command
      ->add_option("--camera", options->camera,
                   "The scene's camera, by name or index [the first; a framing view where it has none]")
      ->type_name("NAME|INDEX");
  command
      ->add_option("--env", options->environment,
                   "Lat-long environment map in nits: .exr or .hdr, 2:1; +Z in the middle, +Y up")
      ->type_name("IMAGE");
  command->add_flag("--indirect-only", options->indirect_only,
                    "Only light with at least one surface between its source and the first surface seen");
  command->add_option("--guard", options->guard, "Leak guard of grid look-ups")
      ->check(CLI::IsMember({"rays", "planes", "off"}))
      ->capture_default_str();
  command->add_option("--interpolation", options->interpolation, "Between grid vertices; tricubic is the B-spline")
      ->check(CLI::IsMember({"trilinear", "tricubic"}))
      ->capture_default_str();
  command->add_option("--reconstruction", options->reconstruction, "Of irradiance from the stored vectors")
      ->check(CLI::IsMember({"optimal", "paper"}))
      ->capture_default_str();
  command
      ->add_option_function<float>(
          "--exposure", [options](float stops) { options->exposure_stops = stops; },
          "Stops for tone-mapped pictures [mean luminance to middle grey, highlights to white]")
      ->check(CLI::Range(-100.0F, 100.0F))
      ->type_name("STOPS");
  command->footer(
      "The same command gives the same bytes with any --threads.\n"
      "Examples:\n"
      "  ivory render room.glb -o room.exr -o room.png --samples 256\n"
      "  ivory render room.glb -o room.png --method gather --grid room.vdb --samples 16 --gather 16");
  set_action(*command, common, Output::file, [command, options, &common] {
    note_ignored(*command, *options, common);
    run_render(*options, common);
  });
}

}  // namespace ivory
