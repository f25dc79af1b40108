#include "tracer/gltf/loader.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "tracer/gltf/accessors.h"
#include "tracer/gltf/document.h"
#include "tracer/gltf/images.h"
#include "tracer/gltf/materials.h"
#include "tracer/gltf/meshes.h"
#include "tracer/gltf/nodes/place.h"
#include "tracer/gltf/pose/animations.h"
#include "tracer/gltf/schema/check.h"
#include "tracer/gltf/stages.h"

namespace ivory {
namespace {

// Meshes that no instance places are of other scenes, or of none.
void drop_unused_meshes(Scene& scene) {
  std::vector<int> target(scene.meshes.size(), no_index);
  for (const Instance& instance : scene.instances) target[std::size_t(instance.mesh)] = 0;
  std::vector<Mesh> kept;
  for (std::size_t i = 0; i < target.size(); ++i) {
    if (target[i] == no_index) continue;
    target[i] = int(kept.size());
    kept.push_back(std::move(scene.meshes[i]));
  }
  scene.meshes = std::move(kept);
  for (Instance& instance : scene.instances) instance.mesh = target[std::size_t(instance.mesh)];
}

void read_distances(const gltf::Document& document, LoadedScene& loaded) {
  for (const tinygltf::Camera& camera : document.model.cameras)
    loaded.camera_near.push_back(camera.type == "perspective" ? camera.perspective.znear : camera.orthographic.znear);
  const nlohmann::json* lights = gltf::find_extension(*document.json, "KHR_lights_punctual");
  if (lights == nullptr) return;
  for (const nlohmann::json& light : (*lights)["lights"])
    if (light.contains("range")) loaded.light_ranges.push_back(light["range"].get<double>());
}

}  // namespace

void gltf::open_document(Document& document, const std::string& path, const LoadParams& params) {
  document.path = path;
  document.uv_sets = {params.uv_sets.begin(), params.uv_sets.end()};
  gltf::read_json(document);
  gltf::check_schema(document);
  gltf::check_extensions(document);
  gltf::read_buffers(document);
  gltf::parse_model(document);
  gltf::check_accessors(document);
}

gltf::BuiltScene gltf::build_scene(Document& document, const LoadParams& params) {
  BuiltScene built;
  Scene& scene = built.scene;
  scene.materials = gltf::make_materials(document);
  scene.textures = gltf::make_textures(document);
  gltf::MeshSet meshes = gltf::make_meshes(document, scene.materials);
  scene.meshes = std::move(meshes.meshes);
  built.material_used = gltf::place_nodes(document, meshes, params, scene);
  built.material_used.resize(scene.materials.size());  // spherical lights brought their own
  drop_unused_meshes(scene);
  if (scene.instances.empty()) document.warn("has no triangles in its scene");
  for (const Mesh& mesh : scene.meshes) built.material_used[std::size_t(mesh.material)] = 1;
  return built;
}

LoadedScene load_gltf(const std::string& path, const LoadParams& params) {
  gltf::Document document;
  gltf::open_document(document, path, params);
  if (!params.time_s && !params.animation.empty()) throw ParameterError("animation", "is of no use without a time");
  if (params.time_s) {
    gltf::apply_animation(document, params.animation, *params.time_s);
  } else {
    gltf::warn_of_animations(document);
  }

  gltf::BuiltScene built = gltf::build_scene(document, params);
  LoadedScene loaded;
  Scene& scene = loaded.scene;
  scene = std::move(built.scene);
  scene.name = path;
  gltf::load_images(document, built.material_used, scene);
  scene.content_hash = fmt::format("{:016x}", document.hash);
  read_distances(document, loaded);
  loaded.files = std::move(document.files);
  loaded.warnings = std::move(document.warnings);
  return loaded;
}

}  // namespace ivory
