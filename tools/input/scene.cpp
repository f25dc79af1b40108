#include "tools/input/scene.h"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/io/file.h"
#include "tools/cli/host.h"
#include "tools/input/assumptions.h"
#include "tools/input/shared.h"
#include "tools/input/units_hint.h"
#include "tracer/lights/sphere.h"

namespace ivory {

namespace {

const std::string scale_key = "scene_scale";  // of assets' metadata; none stands for 1

// By which commands of one host share it.
std::string key_of(const std::string& path, const LoadParams& params) {
  std::string key = fmt::format("{}\n{}\n{}", path, params.scale, params.animation);
  if (params.time_s) key += fmt::format("\n{}", *params.time_s);
  for (const std::string& node : params.without) key += "\nwithout " + node;
  for (const int set : params.uv_sets) key += fmt::format("\nTEXCOORD_{}", set);
  return key;
}

}  // namespace

bool is_scene_name(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".gltf" || extension == ".glb";
}

void check_environment(const std::string& path, const Metadata& metadata, const SceneInput& input,
                       EnvironmentTurn turn) {
  const auto baked = find_text(metadata, "environment_hash");
  const auto given = find_text(input.origin, "environment_hash");
  const bool lit = given.has_value();
  if (!baked) {
    if (lit) throw Error(path, "was baked without an environment map", "leave out --env, or bake it with the same");
    return;
  }
  if (baked == given) {
    const double then = environment_turn_deg(metadata);
    const double now = environment_turn_deg(input.origin);
    if (turn == EnvironmentTurn::free || std::remainder(now - then, 360.0) == 0) return;
    throw Error(path, fmt::format("was baked with --env-turn {} and the scene is taken with --env-turn {}", then, now),
                fmt::format("give --env-turn {}, or bake it again", then));
  }
  const std::string known = find_text(metadata, "environment").value_or("unknown");
  if (lit) throw Error(path, "was baked for another environment (" + known + ")", "bake it for the one given by --env");
  throw Error(path, "was baked for an environment (" + known + ")", "give that by --env, or bake it without");
}

void check_scale(const std::string& path, const Metadata& metadata, const Metadata& scene) {
  const auto same = [&](const char* key) {
    const auto baked = find_text(metadata, key);
    return baked && baked == find_text(scene, key);
  };
  if (!same("scene") && !same("scene_hash")) return;
  const double baked = find_number(metadata, scale_key).value_or(1);
  const double taken = find_number(scene, scale_key).value_or(1);
  if (baked == taken) return;
  throw Error(path, fmt::format("was baked with --scale {} and the scene is taken with --scale {}", baked, taken),
              fmt::format("give --scale {}, or bake it again", baked));
}

std::vector<std::string> add_scene_options(Command command, SceneOptions& options, const std::string& group) {
  Option scale =
      command
          .add_option("--scale", options.load.scale,
                      "Metres a unit of glTF files, for models that are not in metres: 0.01 for centimetres.\n"
                      "Light keeps its units, and positions given here are metres")
          .within(1e-6, 1e6)
          .type_name("FACTOR");
  Option time = command
                    .add_option(
                        "--time",
                        [&options](const std::string& text) {
                          options.load.time_s = parse_number(text);
                          if (!options.load.time_s) throw UsageError("--time takes seconds, not '" + text + "'");
                        },
                        "Poses the scene as its animation has it then, skins and morphs too [as it is stored]")
                    .type_name("SECONDS");
  Option animation = command
                         .add_option("--animation", options.load.animation,
                                     "The animation that --time is of, by name or index [the first]")
                         .needs(time)
                         .type_name("NAME|INDEX");
  Option without = command
                       .add_option("--without", options.load.without,
                                   "A node of the scene to leave out, by name or index, with all below it: an object\n"
                                   "that will move; may be repeated")
                       .repeated()
                       .type_name("NODE");
  if (!group.empty()) {
    for (Option* option : {&scale, &time, &animation, &without}) option->group(group);
  }
  return {"--scale", "--time", "--animation", "--without"};
}

void add_portable_option(Command command, SceneOptions& options) {
  command.add_flag(
      "--portable", options.intersector.portable,
      "The same bytes on every x86-64 CPU, for parts from several kinds of machine. Without, hits of rays\n"
      "differ in their last bits with a CPU's vector instructions. Grids take a tenth to a quarter longer,\n"
      "FIV tables twice as long");
}

LoadParams object_params(const SceneOptions& options) {
  LoadParams params = options.load;
  params.time_s.reset();
  params.animation.clear();
  params.without.clear();
  return params;
}

LoadedScene load_scene(const std::string& path, const LoadParams& params) {
  LoadedScene loaded = load_gltf(path, params);
  if (params.scale == 1) {
    if (const auto hint = units_hint(loaded)) loaded.warnings.push_back(*hint);
  }
  return loaded;
}

void describe(const SceneOptions& options, Metadata& metadata) {
  if (options.load.scale != 1) metadata[scale_key] = options.load.scale;
  if (options.load.time_s) metadata["time_s"] = *options.load.time_s;
  if (!options.load.animation.empty()) metadata["animation"] = options.load.animation;
  if (options.intersector.portable) metadata["hits"] = "portable";
  if (!options.load.without.empty()) metadata["without"] = fmt::format("{}", fmt::join(options.load.without, ", "));
}

LoadedScene load_scene(const std::string& path, const LoadParams& params, const CommonOptions& common) {
  begin_work(common);
  if (common.host == nullptr || common.host->inputs == nullptr) return load_scene(path, params);
  return *common.host->inputs->scenes.get(key_of(path, params), path, [&] { return load_scene(path, params); });
}

namespace {

SceneInput make_scene_input(LoadedScene loaded, const std::string& path, const SceneOptions& options,
                            const EnvironmentChoice& environment, const CommonOptions& common,
                            const std::function<void(Scene&)>& extend) {
  Metadata origin;
  origin["scene"] = std::filesystem::path(path).filename().string();
  origin["scene_hash"] = loaded.scene.content_hash;
  describe(options, origin);
  if (!environment.path.empty()) {
    EnvironmentInput map = load_environment_input(environment, common);
    loaded.scene.environment = to_latlong(std::move(map.image));
    origin.merge(map.origin);
    loaded.warnings.insert(loaded.warnings.end(), map.warnings.begin(), map.warnings.end());
  }
  if (extend) extend(loaded.scene);
  print_warnings(common, loaded.warnings);
  keep_assumptions(origin, loaded.warnings);
  SceneInput input(make_lit_scene(std::move(loaded.scene), options.intersector));
  input.warnings = std::move(loaded.warnings);
  input.origin = std::move(origin);
  return input;
}

}  // namespace

SceneInput load_own_scene_input(const std::string& path, const SceneOptions& options,
                                const EnvironmentChoice& environment, const CommonOptions& common,
                                const std::function<void(Scene&)>& extend) {
  return make_scene_input(load_scene(path, options.load, common), path, options, environment, common, extend);
}

SceneInput load_scene_input(const std::string& path, const SceneOptions& options, const EnvironmentChoice& environment,
                            const CommonOptions& common, const std::function<void(const Scene&)>& inspect) {
  begin_work(common);
  if (common.host == nullptr || common.host->inputs == nullptr)
    return make_scene_input(load_scene(path, options.load), path, options, environment, common, inspect);
  bool made_here = false;
  const std::string key = key_of(path, options.load) + (options.intersector.portable ? "\nportable\n" : "\n") +
                          environment.path + "\n" + environment.layout;
  SceneInput input = *common.host->inputs->lit.get(key, path, [&] {
    made_here = true;  // and its warnings printed
    return make_scene_input(load_scene(path, options.load), path, options, environment, common, {});
  });
  if (!made_here) print_warnings(common, input.warnings);
  if (inspect) inspect(*input.lit.scene);
  return input;
}

SphereLightOption parse_sphere_light(std::string_view option, std::string_view text) {
  const std::vector<double> v = parse_numbers(option, text, 7, "X,Y,Z,RADIUS,R,G,B");
  return {V3d(v[0], v[1], v[2]), float(v[3]), Rgb(float(v[4]), float(v[5]), float(v[6]))};
}

void add_sphere_light(Scene& scene, const SphereLightOption& light, const std::string& source) {
  add_sphere_light(scene, SphereLight{to_local(light.center_m, scene.anchor_m), light.radius_m, light.radiance_nits},
                   source);
}

}  // namespace ivory
