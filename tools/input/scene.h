// The scene that a command works on: the glTF file, the environment map given beside it, and all
// that is built from the two.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "grid/base/metadata.h"
#include "tools/cli/common.h"
#include "tools/input/environment.h"
#include "tracer/core/lit_scene.h"
#include "tracer/gltf/loader.h"

namespace ivory {

// How scenes and objects are read from their files: the options of every command that takes any.
struct SceneOptions {
  LoadParams load;
  IntersectorParams intersector;
};

// --scale, --time, --animation and --without, in the help page's group `group` where that is not empty. Returns the
// options' names.
std::vector<std::string> add_scene_options(Command command, SceneOptions& options, const std::string& group = {});

// --portable, of what is baked and may be put together from parts.
void add_portable_option(Command command, SceneOptions& options);

// For files placed beside the scene: in the scene's unit, but as they are stored, and whole.
LoadParams object_params(const SceneOptions& options);

// load_gltf(), and one more warning where the file looks like another unit than metres and --scale does not say so.
LoadedScene load_scene(const std::string& path, const LoadParams& params);
// The same for a command, which may share it with others (tools/cli/host.h).
LoadedScene load_scene(const std::string& path, const LoadParams& params, const CommonOptions& common);

// What of the options an asset's metadata keeps: scene_scale, where it is not 1; time_s, animation and without, where
// they are given.
void describe(const SceneOptions& options, Metadata& metadata);

struct SceneInput {
  explicit SceneInput(LitScene made) : kept(std::make_shared<const LitScene>(std::move(made))), lit(*kept) {}

  std::shared_ptr<const LitScene> kept;  // maybe by others too
  const LitScene& lit;                   // never without one
  std::vector<std::string> warnings;
  // scene, scene_hash, scene_scale (where it is not 1), environment, environment_hash ...: names without folders,
  // hashes of contents
  Metadata origin;
};

// True for the names that load as scenes: .gltf and .glb, in any case.
bool is_scene_name(const std::string& path);

// Throws Error where `path`, an asset with that metadata, was baked for another environment than `input` has; none is
// an environment like any other, and so is the same one turned otherwise, unless the asset's reader turns it.
enum class EnvironmentTurn { fixed, free };
void check_environment(const std::string& path, const Metadata& metadata, const SceneInput& input,
                       EnvironmentTurn turn = EnvironmentTurn::fixed);

// Throws Error where `path`, an asset with that metadata, was baked from the scene of that metadata (its file by name
// or content) taken at another --scale.
void check_scale(const std::string& path, const Metadata& metadata, const Metadata& scene);

// Loads `path` and, unless its path is empty, the environment map, resampled to lat-long where it has another
// layout; prints the warnings of both as notes. `inspect`, unless empty, sees the scene before what takes time is built
// from it. Commands of one host share what is built. Throws Error as load_gltf() and load_environment() do.
SceneInput load_scene_input(const std::string& path, const SceneOptions& options, const EnvironmentChoice& environment,
                            const CommonOptions& common, const std::function<void(const Scene&)>& inspect = {});
// The same of a scene that `extend` may add to; shared with nobody.
SceneInput load_own_scene_input(const std::string& path, const SceneOptions& options,
                                const EnvironmentChoice& environment, const CommonOptions& common,
                                const std::function<void(Scene&)>& extend);

// A spherical light as a user gives it: its place in the world.
struct SphereLightOption {
  V3d center_m;
  float radius_m = 0;
  Rgb radiance_nits;
};
// "X,Y,Z,RADIUS,R,G,B": place and radius in metres, radiance in nits. Throws UsageError naming `option`.
SphereLightOption parse_sphere_light(std::string_view option, std::string_view text);
// As add_sphere_light(), whose messages name `source`.
void add_sphere_light(Scene& scene, const SphereLightOption& light, const std::string& source);

}  // namespace ivory
