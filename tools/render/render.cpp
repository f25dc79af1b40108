// ivory render: a picture by any of the methods.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/io/file.h"
#include "grid/io/json.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/grid.h"
#include "tools/input/objects.h"
#include "tools/input/scene.h"
#include "tools/render/checkpoint.h"
#include "tools/render/finish.h"
#include "tools/render/method.h"
#include "tools/render/quality.h"
#include "tracer/bake/field/grid_checkpoint.h"
#include "tracer/image/file.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

struct RenderOptions {
  std::string scene;
  std::vector<std::string> outputs;  // one picture in several formats
  std::string method = "path";
  SceneOptions load;
  EnvironmentChoice environment;
  std::string camera;
  std::vector<SphereLightOption> sphere_lights;
  std::vector<std::string> sphere_light_texts;
  QualityOptions quality;
  FinishOptions finish;
  CheckpointOptions checkpoint;
  std::uint64_t seed = 1;
  Imath::V2i size{640, 480};
  std::vector<std::string> objects;
  std::vector<std::string> places;  // OBJECT=PLACE
  std::optional<float> exposure_stops;
  bool indirect_only = false;
};

Camera choose_camera(const RenderOptions& options, const LitScene& lit) {
  if (!options.camera.empty()) return find_camera(*lit.scene, options.camera);
  if (!lit.scene->cameras.empty()) return lit.scene->cameras.front();
  const float aspect = float(options.size.x) / float(options.size.y);
  return framing_camera(lit.intersector.center(), lit.intersector.radius_m(), aspect);
}

View choose_view(const RenderOptions& options, const LitScene& lit) {
  return make_view(options.scene, choose_camera(options, lit), options.size.x, options.size.y);
}

// Says what looks like a mistake.
std::vector<std::string> judge(const RenderOptions& options, const LitScene& lit, const Film& film) {
  const Camera camera = choose_camera(options, lit);
  const View view = choose_view(options, lit);
  std::vector<std::string> warnings;
  if (const auto doubt = doubt_about(lit.intersector, view, camera.name)) {
    warnings.push_back(*doubt);
  } else if (!options.indirect_only && !lit.lights.empty() &&
             std::all_of(film.pixels.begin(), film.pixels.end(), is_black)) {
    // Both sides of a double-sided surface are seen, so that its back alone is no mistake.
    const bool inside = look_around(lit.intersector, view.origin).back_share > 0.75;
    warnings.push_back(fmt::format("the picture is black: no light comes from what camera '{}' sees{}", camera.name,
                                   inside ? ", and it may stand inside a wall" : ""));
  }
  return warnings;
}

Metadata describe(const RenderOptions& options, const RenderMethod& method, const SceneInput& input) {
  Metadata m = input.origin;
  m["version"] = std::string(IVORY_VERSION);
  m["method"] = options.method;
  describe(options.quality, m);
  m["seed"] = std::int64_t(options.seed);
  m["light"] = std::string(options.indirect_only ? "indirect" : "all");
  m["units"] = std::string("nits");
  if (!options.objects.empty()) m["objects"] = fmt::format("{}", fmt::join(options.objects, " "));
  if (!options.places.empty()) m["places"] = fmt::format("{}", fmt::join(options.places, " "));
  if (!options.camera.empty()) m["camera"] = options.camera;
  if (!options.sphere_lights.empty())
    m["sphere_lights"] = fmt::format("{}", fmt::join(options.sphere_light_texts, " "));
  method.describe(m);
  return m;
}

// All that decides the picture's sums.
Metadata identity(const RenderOptions& options, const RenderMethod& method, const SceneInput& input) {
  Metadata m = describe(options, method, input);
  m["size"] = fmt::format("{}x{}", options.size.x, options.size.y);
  m["cpu"] = checkpoint_cpu(input.lit.intersector.portable());
  std::string hashes;
  for (const std::string& object : options.objects) {
    const std::string file = object.substr(0, object.find('@'));
    if (is_scene_name(file)) hashes += file_hash(file);
  }
  if (method.files) {
    for (const std::string& file : method.files()) hashes += file_hash(file);
  }
  if (!hashes.empty()) m["files_hash"] = text_hash(hashes);
  return m;
}

Rendered render(const RenderOptions& options, const RenderMethod& method, const SceneInput& input,
                const std::vector<bool>& is_object, KeptCheckpoint& kept, const CommonOptions& common) {
  const View view = choose_view(options, input.lit);
  if (input.lit.lights.empty()) print_note(common, fmt::format("warning: nothing in {} emits light", options.scene));
  RenderParams params;
  apply(options.quality, params);
  apply(options.finish, input.lit, params);
  params.seed = options.seed;
  params.threads = thread_count(common);
  Progress progress(common, "rendering", options.quality.is_adaptive() ? "per mille" : "samples");
  const std::uint64_t total =
      options.quality.is_adaptive()
          ? 1000
          : std::uint64_t(options.quality.samples) * std::uint64_t(view.width) * std::uint64_t(view.height);
  params.progress = [&](double fraction) { progress.update(std::uint64_t(fraction * double(total)), total); };
  std::optional<PictureCheckpoint> checkpoint;
  if (const auto policy = kept.policy(progress)) checkpoint.emplace(*policy, params);
  return method.render({input, view, params, is_object, options.indirect_only, common});
}

// "direct, gather" for "--grid".
std::map<std::string, std::string> readers_of_options(const std::vector<RenderMethod>& methods) {
  std::map<std::string, std::string> readers;
  for (const RenderMethod& method : methods) {
    for (const std::string& option : method.options)
      readers[option] += (readers[option].empty() ? "" : ", ") + method.name;
  }
  return readers;
}

// Scripts run one line with several methods, so options of another method are no error; but said.
void note_ignored(const Command& command, const RenderOptions& options, const std::vector<RenderMethod>& methods,
                  const CommonOptions& common) {
  const auto chosen = std::find_if(methods.begin(), methods.end(),
                                   [&](const RenderMethod& method) { return method.name == options.method; });
  for (const auto& [option, names] : readers_of_options(methods)) {
    const bool read = std::find(chosen->options.begin(), chosen->options.end(), option) != chosen->options.end();
    if (!read && command.get_option(option).given())
      print_note(common, fmt::format("note: {} is ignored, it serves --method {}", option, names));
  }
  if (options.exposure_stops && std::all_of(options.outputs.begin(), options.outputs.end(), is_linear_image))
    print_note(common, "note: --exposure is ignored, it serves tone-mapped pictures (.png, .jpg)");
}

void run_render(const RenderOptions& options, const RenderMethod& method, const CommonOptions& common) {
  if (method.uses_objects && options.objects.empty())
    throw UsageError("--method " + options.method + " needs --object FILE.glb@X,Y,Z or a node of the scene");
  if (method.uses_objects && options.indirect_only)
    throw UsageError("--method " + options.method + " cannot leave out direct light: --indirect-only serves others");
  if (method.needs_environment && options.environment.path.empty())
    throw UsageError("--method " + options.method + " lights by an environment: give --env");
  if (method.direct_only && options.indirect_only)
    throw UsageError("--method " + options.method + " renders direct light: --indirect-only leaves nothing");
  if (options.checkpoint.is_given && options.checkpoint.minutes > 0 && options.quality.max_seconds)
    throw UsageError("--checkpoint: what --max-time decides by the clock cannot be gone on from; give one of the two");
  if (method.check) method.check();
  std::vector<NamedPlace> places;
  for (const std::string& text : options.places) places.push_back(parse_named_place(text));
  if (!places.empty() && options.objects.empty())
    throw UsageError("--place: there is no object '" + places.front().object + "' (--object)");
  std::set<std::filesystem::path> files;
  for (const std::string& output : options.outputs) {
    check_output(output, common);
    check_image_name(output);
    if (!files.insert(std::filesystem::weakly_canonical(std::filesystem::absolute(output))).second)
      throw UsageError("--output: " + output + " is given twice");
  }
  std::vector<bool> is_object;
  const bool extended = !options.objects.empty() || !options.sphere_lights.empty() || method.extend;
  const auto input =
      !extended ? load_scene_input(options.scene, options.load, options.environment, common)
                : load_own_scene_input(options.scene, options.load, options.environment, common, [&](Scene& scene) {
                    is_object = place_objects(scene, options.objects, places, options.load, common);
                    for (const SphereLightOption& light : options.sphere_lights)
                      add_sphere_light(scene, light, "--sphere-light");
                    if (method.extend) method.extend(scene);
                  });
  is_object.resize(input.lit.scene->instances.size(), false);

  CheckpointOptions checkpoint = options.checkpoint;
  if (options.quality.max_seconds) checkpoint.minutes = 0;
  KeptCheckpoint kept(checkpoint, fs::path(options.outputs.front()).replace_extension(".exr").string(),
                      identity(options, method, input), common, "samples");
  const auto start = std::chrono::steady_clock::now();
  Rendered rendered = render(options, method, input, is_object, kept, common);
  kept.baked();
  Film& film = rendered.film;
  const std::optional<FilteredFilm> filtered = filter(options.finish, film, thread_count(common));
  if (filtered) film.pixels = filtered->film.pixels;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  std::vector<std::string> warnings = judge(options, input.lit, film);
  warnings.insert(warnings.end(), rendered.doubts.begin(), rendered.doubts.end());
  for (const std::string& doubt : doubts(options.quality, film)) warnings.push_back(doubt);
  print_warnings(common, warnings);

  Metadata metadata = describe(options, method, input);
  metadata.insert(rendered.found.begin(), rendered.found.end());
  describe(options.quality, film, metadata);
  if (filtered) describe(*filtered, metadata);
  const bool any_display = !std::all_of(options.outputs.begin(), options.outputs.end(), is_linear_image);
  const float exposure = options.exposure_stops.value_or(any_display ? auto_exposure(film) : 0);
  const std::vector<ImageChannel> more = layers(options.finish, film);
  for (const std::string& output : options.outputs) {
    Metadata own = metadata;
    if (!is_linear_image(output)) own["exposure_stops"] = double(exposure);
    write_image(output, film, exposure, own, common.force, more);
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
  result.update(to_json(metadata));
  if (any_display) result["exposure_stops"] = exposure;
  result["mean_radiance_nits"] = {mean[0], mean[1], mean[2]};
  if (film.noise) result["error"] = noise_json(options.quality, *film.noise);
  if (filtered) result["filter"] = filter_json(*filtered);
  result["seconds"] = seconds;
  result["render_seconds"] = film.render_seconds;
  std::vector<std::string> all = input.warnings;
  all.insert(all.end(), warnings.begin(), warnings.end());
  result["warnings"] = all;
  kept.finish(result);
  std::string human = fmt::format("{}: {} x {}, {}, {}, mean {:.4g} {:.4g} {:.4g} nits, {:.2f} s\n",
                                  fmt::join(options.outputs, ", "), film.width, film.height, options.method,
                                  samples_text(options.quality, film), mean[0], mean[1], mean[2], seconds);
  human += noise_text(options.quality, film);
  if (filtered) human += filter_text(*filtered);
  if (film.noise && !method.noise_note.empty()) human += "(" + method.noise_note + ")\n";
  if (any_display) human += fmt::format("exposure {:+.2f} stops\n", exposure);
  print_result(common, result, human);
}

}  // namespace

void add_render_command(Command app, CommonOptions& common) {
  Command command = app.add_subcommand("render", "Render a picture by path tracing or from baked assets");
  auto options = std::make_shared<RenderOptions>();
  command.add_option("scene", options->scene, "Scene: .gltf or .glb, metres, +Y up").required().type_name("SCENE");
  command
      .add_option("-o,--output", options->outputs,
                  "Picture to write: .exr, .hdr, .tif keep linear nits; .png, .jpg are tone-mapped; may be repeated")
      .repeated()
      .required()
      .type_name("IMAGE");
  Option method_option = command.add_option("--method", options->method);
  add_quality_options(command, options->quality);
  add_finish_options(command, options->finish);
  command.add_count("--seed", options->seed, "Seed of the random numbers");
  command.add_image_size("--size", options->size, "Size of the picture in pixels");
  command
      .add_option("--camera", options->camera,
                  "The scene's camera, by name or index [the first; a framing view where it has none]")
      .type_name("NAME|INDEX");
  add_environment_options(command, options->environment);
  add_scene_options(command, options->load);
  command
      .add_option("--object", options->objects,
                  "An object that moves: a model placed in the scene, or a node of the scene; may be repeated.\n"
                  "Methods other than cubemap light it like all else")
      .repeated()
      .type_name("FILE.glb[@PLACE]|NODE");
  add_place_option(command, options->places);
  command.add_flag("--indirect-only", options->indirect_only,
                   "Only light with at least one surface between its source and the first surface seen");
  command
      .add_option("--exposure", options->exposure_stops,
                  "Stops for tone-mapped pictures [mean luminance to middle grey, highlights to white]")
      .within(-100.0, 100.0)
      .type_name("STOPS");
  command
      .add_option(
          "--sphere-light",
          [options](const std::string& text) {
            options->sphere_lights.push_back(parse_sphere_light("--sphere-light", text));
            options->sphere_light_texts.push_back(text);
          },
          "Adds a spherical light: place and radius in metres, radiance in nits; may be repeated")
      .repeated()
      .type_name("X,Y,Z,RADIUS,R,G,B");
  add_checkpoint_option(
      command, options->checkpoint,
      "Keeps what is rendered so far in OUT.checkpoint.exr, so often and at Ctrl-C or SIGTERM: a picture\n"
      "to look at meanwhile, from which the same command goes on after whatever stopped it, to the same\n"
      "bytes. 0 keeps none");
  auto methods = std::make_shared<std::vector<RenderMethod>>();
  methods->push_back(make_path_method(command));
  const auto grid = add_grid_options(command, "Baked grid of indirect light");
  const auto gather = add_gather_option(command);
  for (RenderMethod& method : make_grid_methods(command, grid, gather)) methods->push_back(std::move(method));
  methods->push_back(make_photonmap_method(command, gather));
  methods->push_back(make_cubemap_method(command, grid));
  methods->push_back(make_lobes_method(command));
  methods->push_back(make_fiv_method(command));
  std::vector<std::string> names;
  std::string summary;
  for (const RenderMethod& method : *methods) {
    names.push_back(method.name);
    summary += (summary.empty() ? "" : "\n") + method.name + ": " + method.summary;
  }
  method_option.description(summary).one_of(names);
  for (const auto& [option, readers] : readers_of_options(*methods))
    command.get_option(option).group("For --method " + readers);
  command.footer(
      "The same command gives the same bytes with any --threads, but for --max-time.\n"
      "--json: render_seconds is the wall time of the picture's rays and shading alone, the same for all methods;\n"
      "seconds adds what the method loads or makes for the picture: the grid, the photon map, tables of lobes, sphere\n"
      "sets, occluders, cube maps. Neither counts loading the scene and writing the picture.\n"
      "\nExamples:\n"
      "  ivory render room.glb -o room.exr -o room.png --samples 256\n"
      "  ivory render room.glb -o room.exr --target-error 2%\n"
      "  ivory render room.glb -o room.png --method gather --grid room.vdb --samples 64");
  set_action(command, common, Output::file, [command, options, methods, &common] {
    check(command, options->quality);
    check(options->finish, options->outputs);
    note_ignored(command, *options, *methods, common);
    const auto chosen = std::find_if(methods->begin(), methods->end(),
                                     [&](const RenderMethod& method) { return method.name == options->method; });
    run_render(*options, *chosen, common);
  });
}

}  // namespace ivory
