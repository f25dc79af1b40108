#include "tools/input/objects.h"

#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"

namespace ivory {

namespace {

// For each node: is it, or one above it, of that name?
std::vector<bool> nodes_below(const Scene& scene, const std::string& name) {
  std::vector<bool> below(scene.nodes.size(), false);
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    for (int node = int(i); node != no_index && !below[i]; node = scene.nodes[std::size_t(node)].parent)
      below[i] = scene.nodes[std::size_t(node)].name == name;
  }
  return below;
}

// For each instance: does it belong to the node of that name?
std::vector<bool> instances_below(const Scene& scene, const std::string& name) {
  const std::vector<bool> below = nodes_below(scene, name);
  std::vector<bool> found(scene.instances.size(), false);
  bool any = false;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const int node = scene.instances[i].node;
    found[i] = node != no_index && below[std::size_t(node)];
    any = any || found[i];
  }
  if (!any) throw UsageError(fmt::format("{} has no node '{}' with a mesh", scene.name, name));
  return found;
}

// All of `object`, moved in the world; handles are shifted past those of `scene`.
void append(Scene& scene, Scene object, const V3d& translation) {
  const V3f offset = to_local(object.anchor_m + translation, scene.anchor_m);
  const int images = int(scene.images.size());
  const int textures = int(scene.textures.size());
  const int materials = int(scene.materials.size());
  const int meshes = int(scene.meshes.size());
  const int nodes = int(scene.nodes.size());
  const int instances = int(scene.instances.size());
  const auto shift = [](int& handle, int by) {
    if (handle != no_index) handle += by;
  };
  for (Texture& texture : object.textures) shift(texture.image, images);
  for (Material& m : object.materials) {
    for (const auto slot : texture_slots) shift((m.*slot).texture, textures);
  }
  for (Mesh& mesh : object.meshes) shift(mesh.material, materials);
  for (SceneNode& node : object.nodes) shift(node.parent, nodes);
  for (Instance& instance : object.instances) {
    shift(instance.mesh, meshes);
    shift(instance.node, nodes);
    for (unsigned c = 0; c < 3; ++c) instance.to_world[3][c] += offset[c];
  }
  for (SphereLight& light : object.sphere_lights) {
    shift(light.instance, instances);
    light.center += offset;
  }
  const auto move = [](auto& to, auto& from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  };
  move(scene.images, object.images);
  move(scene.textures, object.textures);
  move(scene.materials, object.materials);
  move(scene.meshes, object.meshes);
  move(scene.nodes, object.nodes);
  move(scene.instances, object.instances);
  move(scene.sphere_lights, object.sphere_lights);
}

}  // namespace

std::optional<ObjectFile> parse_object(const std::string& text) {
  if (is_scene_name(text)) return ObjectFile{text, V3d(0, 0, 0)};
  const std::size_t at = text.rfind('@');
  if (at == std::string::npos || !is_scene_name(text.substr(0, at))) return std::nullopt;
  return ObjectFile{text.substr(0, at), parse_vector3("--object", text.substr(at + 1))};
}

std::vector<bool> place_objects(Scene& scene, const std::vector<std::string>& objects, const SceneOptions& options,
                                const CommonOptions& common) {
  std::vector<bool> is_object(scene.instances.size(), false);
  for (const std::string& text : objects) {
    const std::optional<ObjectFile> file = parse_object(text);
    if (!file) {
      const std::vector<bool> found = instances_below(scene, text);
      for (std::size_t i = 0; i < found.size(); ++i) is_object[i] = is_object[i] || found[i];
      continue;
    }
    LoadedScene loaded = load_scene(file->path, object_params(options), common);
    print_warnings(common, loaded.warnings);
    if (loaded.scene.instances.empty())
      throw Error(file->path, "has no triangles", "give --object a model with a mesh");
    if (!loaded.scene.lights.empty())
      print_note(common, fmt::format("note: the punctual lights of {} are left out", file->path));
    append(scene, std::move(loaded.scene), file->translation);
    is_object.resize(scene.instances.size(), true);
  }
  return is_object;
}

std::vector<bool> instances_below(const Scene& scene, int node) {
  std::vector<bool> found(scene.instances.size(), false);
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (int above = scene.instances[i].node; above != no_index && !found[i];
         above = scene.nodes[std::size_t(above)].parent)
      found[i] = above == node;
  }
  return found;
}

namespace {

void remove_instances(Scene& scene, const std::vector<bool>& found) {
  std::vector<Instance> kept;
  std::vector<SphereLight> kept_lights;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i]) continue;
    for (SphereLight light : scene.sphere_lights) {
      if (light.instance != int(i)) continue;
      light.instance = int(kept.size());
      kept_lights.push_back(light);
    }
    kept.push_back(scene.instances[i]);
  }
  scene.instances = std::move(kept);
  scene.sphere_lights = std::move(kept_lights);
}

// Meshes that nothing places, and images that no material of the others shows, lose what takes memory.
void empty_unused(Scene& scene) {
  std::vector<bool> mesh_used(scene.meshes.size(), false);
  for (const Instance& instance : scene.instances) mesh_used[std::size_t(instance.mesh)] = true;
  std::vector<bool> image_used(scene.images.size(), false);
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const int material = scene.meshes[i].material;
    if (!mesh_used[i]) {
      scene.meshes[i] = Mesh{};
      scene.meshes[i].material = material;
      continue;
    }
    const Material& m = scene.materials[std::size_t(material)];
    for (const auto slot : texture_slots) {
      if ((m.*slot).texture == no_index) continue;
      const int image = scene.textures[std::size_t((m.*slot).texture)].image;
      if (image != no_index) image_used[std::size_t(image)] = true;
    }
  }
  for (std::size_t i = 0; i < scene.images.size(); ++i) {
    if (!image_used[i]) scene.images[i] = Image{};
  }
}

}  // namespace

Scene take_node(Scene& scene, const std::string& name) {
  const std::vector<bool> found = instances_below(scene, name);
  std::vector<bool> others(found);
  others.flip();
  Scene taken = scene;
  taken.name = name;
  remove_instances(taken, others);
  taken.lights.clear();
  taken.cameras.clear();
  taken.environment.reset();
  remove_instances(scene, found);
  empty_unused(taken);
  empty_unused(scene);
  return taken;
}

}  // namespace ivory
