#include "tools/input/objects.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "tools/cli/numbers.h"

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

// Instance and what it lights by itself, as `placement` says.
void move_instance(Scene& scene, std::size_t i, const Placement& placement) {
  Instance& instance = scene.instances[i];
  // A place that turns nothing adds to the numbers that are there, as exactly as they were stored.
  if (placement.turn_deg == V3f(0, 0, 0) && placement.scale == 1) {
    for (unsigned c = 0; c < 3; ++c) instance.to_world[3][c] += placement.offset_m[c];
  } else {
    const Imath::M44d moved = Imath::M44d(instance.to_world) * Imath::M44d(to_matrix(placement));
    instance.to_world = M44f(moved);
  }
  for (SphereLight& light : scene.sphere_lights) {
    if (light.instance != int(i)) continue;
    light.center = placed(placement, light.center);
    light.radius_m *= placement.scale;
  }
}

// All of `object`, moved in the world; handles are shifted past those of `scene`.
void append(Scene& scene, Scene object, const ObjectPlace& place) {
  const Placement placement{to_local(object.anchor_m + place.offset_m, scene.anchor_m), place.turn_deg, place.scale,
                            pivot_of_file(object)};
  for (std::size_t i = 0; i < object.instances.size(); ++i) move_instance(object, i, placement);
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
  }
  for (SphereLight& light : object.sphere_lights) shift(light.instance, instances);
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

ObjectPlace parse_place(std::string_view option, std::string_view text) {
  constexpr std::string_view form = "X,Y,Z[,RX,RY,RZ[,SCALE]]: metres, degrees about +X, +Y and +Z, a factor";
  const auto commas = std::size_t(std::count(text.begin(), text.end(), ','));
  const std::size_t count = commas >= 6 ? 7 : commas >= 3 ? 6 : 3;
  const std::vector<double> v = parse_numbers(option, text, count, form);
  ObjectPlace place;
  place.offset_m = {v[0], v[1], v[2]};
  if (count > 3) place.turn_deg = V3f(V3d(v[3], v[4], v[5]));
  if (count > 6) place.scale = float(v[6]);
  if (!(place.scale >= 1e-6F && place.scale <= 1e6F))
    throw UsageError(fmt::format("{}: a scale is from 0.000001 to 1000000, not {}", option, v.back()));
  return place;
}

NamedPlace parse_named_place(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0)
    throw UsageError(fmt::format("--place: '{}' is not OBJECT=X,Y,Z[,RX,RY,RZ[,SCALE]]", text));
  return {text.substr(0, equals), parse_place("--place", std::string_view(text).substr(equals + 1))};
}

Option add_place_option(Command command, std::vector<std::string>& places) {
  return command
      .add_option("--place", places,
                  "How the object of that name (node or file) stands: moved by X,Y,Z metres from where its file has\n"
                  "it, turned by degrees about +X, then +Z, then +Y, and scaled, about the origin of its file or of\n"
                  "the node's first mesh; may be repeated. --object FILE.glb@PLACE takes the same numbers")
      .repeated()
      .type_name("OBJECT=X,Y,Z[,RX,RY,RZ[,SCALE]]");
}

V3f pivot_of_node(const Scene& scene, const std::string& name) {
  const std::vector<bool> found = instances_below(scene, name);
  const auto first = std::size_t(std::find(found.begin(), found.end(), true) - found.begin());
  const M44f& m = scene.instances[first].to_world;
  return {m[3][0], m[3][1], m[3][2]};
}

V3f pivot_of_file(const Scene& object) { return to_local(V3d(0, 0, 0), object.anchor_m); }

std::optional<ObjectFile> parse_object(const std::string& text) {
  if (is_scene_name(text)) return ObjectFile{text, {}};
  const std::size_t at = text.rfind('@');
  if (at == std::string::npos || !is_scene_name(text.substr(0, at))) return std::nullopt;
  return ObjectFile{text.substr(0, at), parse_place("--object", std::string_view(text).substr(at + 1))};
}

std::vector<bool> place_objects(Scene& scene, const std::vector<std::string>& objects,
                                const std::vector<NamedPlace>& places, const SceneOptions& options,
                                const CommonOptions& common) {
  std::vector<bool> is_object(scene.instances.size(), false);
  std::vector<bool> used(places.size(), false);
  const auto place_of = [&](const std::string& name) {
    std::optional<ObjectPlace> place;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (places[i].object != name) continue;
      place = places[i].place;
      used[i] = true;
    }
    return place;
  };
  for (const std::string& text : objects) {
    const std::optional<ObjectFile> file = parse_object(text);
    if (!file) {
      const std::vector<bool> found = instances_below(scene, text);
      const std::optional<ObjectPlace> place = place_of(text);
      const V3f pivot = pivot_of_node(scene, text);
      for (std::size_t i = 0; i < found.size(); ++i) {
        is_object[i] = is_object[i] || found[i];
        if (found[i] && place) move_instance(scene, i, {V3f(place->offset_m), place->turn_deg, place->scale, pivot});
      }
      continue;
    }
    LoadedScene loaded = load_scene(file->path, object_params(options), common);
    print_warnings(common, loaded.warnings);
    if (loaded.scene.instances.empty())
      throw Error(file->path, "has no triangles", "give --object a model with a mesh");
    if (!loaded.scene.lights.empty())
      print_note(common, fmt::format("note: the punctual lights of {} are left out", file->path));
    const std::string name = std::filesystem::path(file->path).filename().string();
    append(scene, std::move(loaded.scene), place_of(name).value_or(file->place));
    is_object.resize(scene.instances.size(), true);
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!used[i]) throw UsageError(fmt::format("--place: there is no object '{}' (--object)", places[i].object));
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
