#include "tracer/gltf/nodes/place.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <ImathMatrixAlgo.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/memory.h"
#include "tracer/gltf/accessors.h"
#include "tracer/gltf/extras.h"
#include "tracer/gltf/geometry.h"
#include "tracer/gltf/nodes/extent.h"
#include "tracer/gltf/nodes/lights.h"
#include "tracer/gltf/nodes/tree.h"
#include "tracer/lights/sphere.h"

namespace ivory::gltf {
namespace {

using Imath::M44d;
using nlohmann::json;

// Below this a side of the transform counts as flattened: products of two such lengths, squared,
// come near the end of float.
constexpr double min_scale = 1e-6;

// The Instance, its matrix in double precision, and Embree's instance with its share of the hierarchy: 514 bytes as
// measured at the peak, and a quarter more.
constexpr double bytes_per_instance = 640;
// A spherical light's 5120 triangles and their places in the tables of emitters, 220 bytes each.
constexpr double bytes_per_sphere_light = 5120 * (bytes_per_triangle + 220) + 2562 * bytes_per_vertex;

M44f to_float(const M44d& m) {
  M44f result;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) result[i][k] = float(m[i][k]);
  return result;
}

class Placer {
 public:
  Placer(Document& document, const MeshSet& meshes, const LoadParams& params, Scene& scene)
      : document_(document),
        meshes_(meshes),
        scale_(params.scale),
        scene_(scene),
        extent_(document, scene),
        left_out_materials_(scene.materials.size(), 0) {}

  // Of every node, before the first is placed: where it will stand in the world, metres. `file` is the transform of the
  // file itself, which `world` ends with.
  void measure(std::size_t index, const M44d& file, const M44d& world, bool visible, bool left_out) {
    const tinygltf::Node& node = document_.model.nodes[index];
    for (int i = 0; i < 16; ++i) {
      if (!(std::abs(world[i / 4][i % 4]) < 1e30))
        document_.fail(node_label(document_, index) + " has a transform that is not finite", remedy);
    }
    if (!visible || left_out) return;
    if (const std::optional<SphereLight> light = read_sphere_light(document_, index, to_float(world)))
      extent_.add_ball(index, row(world, 3), double(light->radius_m));
    if (node.mesh < 0) return;
    const json* instancing = find_instancing(index);
    if (instancing == nullptr) count_instances(index, 1);
    for (const int primitive : meshes_.of_node[index]) {
      if (meshes_.unlit[std::size_t(primitive)] != no_index) continue;
      if (instancing != nullptr) {
        const std::vector<M44d>& locals = instance_matrices(index, *instancing);
        extent_.check_steps(index, primitive, locals);
        for (const M44d& local : locals) extent_.add_mesh(index, primitive, local * world);
      } else {
        extent_.add_mesh(index, primitive, stands_at(primitive, file, world));
      }
    }
  }

  // The world's place of the scene, once all nodes are measured.
  V3d choose_anchor() { return extent_.choose_anchor(); }

  // `file` and `world` less the scene's anchor. `left_out`: by the caller's wish, for what its file would show.
  void place(std::size_t index, const M44d& file, const M44d& world, bool visible, bool left_out) {
    const tinygltf::Node& node = document_.model.nodes[index];
    const json& source = element(document_, "nodes", index);
    if (node.camera >= 0) add_camera(index, std::size_t(node.camera), world);
    if (!visible) return;
    if (left_out) {
      for (const int primitive : meshes_.of_node[index])
        left_out_materials_[std::size_t(scene_.meshes[std::size_t(primitive)].material)] = 1;
      return;
    }
    if (const json* light = find_extension(source, "KHR_lights_punctual")) {
      if (const auto found = read_light(document_, (*light)["light"].get<std::size_t>(), index, world)) {
        scene_.lights.push_back(*found);
        scene_.light_nodes.push_back(int(index));
      }
    }
    if (const std::optional<SphereLight> light = read_sphere_light(document_, index, to_float(world))) {
      add_sphere_light(scene_, *light, document_.path);
      scene_.instances.back().node = int(index);
    }
    if (node.mesh < 0) return;
    if (const json* instancing = find_instancing(index)) {
      for (const M44d& local : instance_matrices(index, *instancing)) add_mesh(index, file, local * world);
    } else {
      if (find_extension(source, "EXT_mesh_gpu_instancing") != nullptr)
        document_.warn(node_label(document_, index) + " instances a skinned mesh; its joints place it, once");
      add_mesh(index, file, world);
    }
  }

  // An unlit surface shows its colour whatever light falls on it, and in the programs that such files come from neither
  // shines nor throws a shadow: a dome with a picture of the sky must not put out the sun behind it.
  void warn_of_unlit() {
    for (const auto& [material, triangles] : unlit_triangles_) {
      document_.warn(fmt::format(
          "{} is unlit: its surfaces neither shine, nor hide or receive light, and are left out ({} triangles)",
          label("materials", std::size_t(material), document_.model.materials[std::size_t(material)].name), triangles));
    }
  }

  std::vector<char> left_out_materials() const { return left_out_materials_; }

 private:
  // Null where the node's skin places its mesh.
  const json* find_instancing(std::size_t index) const {
    if (document_.model.nodes[index].skin >= 0) return nullptr;
    return find_extension(element(document_, "nodes", index), "EXT_mesh_gpu_instancing");
  }

  // A skinned mesh stands where its joints have put it, not under its node.
  M44d stands_at(int primitive, const M44d& file, const M44d& world) const {
    const std::optional<V3d>& origin = meshes_.world_origin[std::size_t(primitive)];
    return origin ? M44d().setTranslation(*origin) * file : world;
  }

  // A few bytes of file can place any number: an accessor of zeros that instances a mesh, many nodes that share a
  // mesh of many primitives.
  void count_instances(std::size_t node, std::size_t count) {
    const std::vector<int>& primitives = meshes_.of_node[node];
    bytes_ += double(count) * double(primitives.size()) * bytes_per_instance;
    check_memory(document_.path, bytes_, "place fewer instances");
  }

  // EXT_mesh_gpu_instancing: one instance an element, its transform before the node's. Counted when first asked for.
  const std::vector<M44d>& instance_matrices(std::size_t index, const json& extension) {
    const auto known = instance_matrices_.find(index);
    if (known != instance_matrices_.end()) return known->second;
    return instance_matrices_[index] = read_instance_matrices(index, extension);
  }

  std::vector<M44d> read_instance_matrices(std::size_t index, const json& extension) {
    const std::string what = node_label(document_, index) + " (EXT_mesh_gpu_instancing)";
    const json& attributes = extension["attributes"];
    std::vector<V3f> translations;
    std::vector<V4f> rotations;
    std::vector<V3f> scales;
    if (attributes.contains("TRANSLATION")) translations = read_vec3(document_, attributes["TRANSLATION"], what);
    if (attributes.contains("ROTATION")) rotations = read_vec4(document_, attributes["ROTATION"], what);
    if (attributes.contains("SCALE")) scales = read_vec3(document_, attributes["SCALE"], what);
    const std::size_t count = std::max({translations.size(), rotations.size(), scales.size()});
    for (const std::size_t size : {translations.size(), rotations.size(), scales.size()})
      if (size != 0 && size != count) document_.fail(what + " has attributes of different counts", remedy);
    count_instances(index, count);
    // "Instance attributes are optional; without TRANSLATION, ROTATION or SCALE the node stands once."
    if (count == 0) return {M44d()};
    std::vector<M44d> matrices;
    matrices.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const V3d translation = translations.empty() ? V3d(0) : V3d(translations[i]);
      const V3d scale = scales.empty() ? V3d(1) : V3d(scales[i]);
      const Imath::Quatd rotation =
          rotations.empty()
              ? Imath::Quatd()
              : checked_rotation(document_, what, rotations[i].x, rotations[i].y, rotations[i].z, rotations[i].w);
      matrices.push_back(trs_matrix(translation, rotation, scale));
    }
    return matrices;
  }

  void add_mesh(std::size_t node, const M44d& file, const M44d& world) {
    for (const int primitive : meshes_.of_node[node]) {
      if (const int unlit = meshes_.unlit[std::size_t(primitive)]; unlit != no_index) {
        unlit_triangles_[unlit] += scene_.meshes[std::size_t(primitive)].triangles.size();
        continue;
      }
      add_primitive(node, primitive, stands_at(primitive, file, world));
    }
  }

  void add_primitive(std::size_t node, int primitive, const M44d& world) {
    const double sides[] = {row(world, 0).length(), row(world, 1).length(), row(world, 2).length()};
    const double volume = std::abs(row(world, 0).cross(row(world, 1)).dot(row(world, 2)));
    const bool flat =
        std::min({sides[0], sides[1], sides[2]}) < min_scale || volume < 1e-7 * sides[0] * sides[1] * sides[2];
    const M44d from_mesh = M44d().setTranslation(extent_.mesh_offset(primitive)) * world;
    Instance instance{primitive, to_float(from_mesh), int(node)};
    if (flat && !add_flat_mesh(node, instance)) return;
    scene_.instances.push_back(instance);
  }

  // A transform that loses a dimension has no inverse, which shading and ray tracing need. What it
  // leaves of the mesh is made a mesh of its own in world space.
  bool add_flat_mesh(std::size_t node, Instance& instance) {
    const Mesh& shared = scene_.meshes[std::size_t(instance.mesh)];
    bytes_ += double(shared.positions.size()) * bytes_per_vertex + double(shared.triangles.size()) * bytes_per_triangle;
    check_memory(document_.path, bytes_, "give its instances scales other than 0");
    Mesh mesh = shared;
    for (V3f& p : mesh.positions) p = p * instance.to_world;
    mesh.normals.clear();
    mesh.tangents.clear();
    drop_degenerate_triangles(mesh);
    if (mesh.triangles.empty()) {
      document_.warn(node_label(document_, node) + " scales its mesh to nothing; left out");
      return false;
    }
    drop_unused_vertices(mesh);
    const TextureUse& normal_use = scene_.materials[std::size_t(mesh.material)].normal_texture;
    if (normal_use.texture != no_index) {
      make_flat_normals(mesh);
      generate_tangents(mesh, normal_use);
    }
    instance = {int(scene_.meshes.size()), M44f(), int(node)};
    scene_.meshes.push_back(std::move(mesh));
    return true;
  }

  // Right-handed, without scale: a node neither zooms a camera, nor may it mirror the picture.
  void add_camera(std::size_t node, std::size_t index, const M44d& world) {
    const tinygltf::Camera& source = document_.model.cameras[index];
    const V3d z = row(world, 2).normalized();
    const V3d x = row(world, 1).cross(z).normalized();
    if (z.length() == 0 || x.length() == 0) {
      document_.warn(node_label(document_, node) + " scales its camera to nothing; left out");
      return;
    }
    const V3d y = z.cross(x);
    M44d frame;
    for (int k = 0; k < 3; ++k) {
      frame[0][k] = x[k];
      frame[1][k] = y[k];
      frame[2][k] = z[k];
      frame[3][k] = world[3][k];
    }
    Camera camera;
    camera.name = source.name.empty() ? document_.model.nodes[node].name : source.name;
    camera.to_world = to_float(frame);
    camera.perspective = source.type == "perspective";
    if (camera.perspective) {
      camera.yfov_rad = float(source.perspective.yfov);
    } else {
      camera.ymag_m = float(source.orthographic.ymag * scale_);
    }
    camera.near_m = float((camera.perspective ? source.perspective.znear : source.orthographic.znear) * scale_);
    // tinygltf has 0 where a perspective camera has no far plane.
    const double far = camera.perspective ? source.perspective.zfar : source.orthographic.zfar;
    if (far > 0) camera.far_m = float(far * scale_);
    scene_.cameras.push_back(camera);
  }

  static V3d row(const M44d& m, int i) { return {m[i][0], m[i][1], m[i][2]}; }

  Document& document_;
  const MeshSet& meshes_;
  double scale_;  // metres a unit of the file
  Scene& scene_;
  Extent extent_;
  std::map<std::size_t, std::vector<M44d>> instance_matrices_;  // [node]
  std::map<int, std::size_t> unlit_triangles_;                  // by the file's material
  std::vector<char> left_out_materials_;                        // [material]
  double bytes_ = 0;                                            // of what is placed, here and in the ray tracer
};

}  // namespace

std::vector<char> place_nodes(Document& document, const MeshSet& meshes, const LoadParams& params, Scene& scene) {
  double sphere_lights = 0;
  for (std::size_t i = 0; i < document.model.nodes.size(); ++i)
    sphere_lights += read_sphere_light(document, i, M44f()) ? 1 : 0;
  check_memory(document.path, sphere_lights * bytes_per_sphere_light, "place fewer spherical lights");
  const std::vector<int> parents = find_parents(document);
  // Of all nodes, so that a broken one is found even where this scene does not use it.
  std::vector<M44d> locals;
  for (std::size_t i = 0; i < parents.size(); ++i) locals.push_back(local_matrix(document, i));
  struct Open {
    std::size_t node;
    M44d parent_world;
    bool visible;
    bool left_out;
  };
  const std::vector<char> unwanted = find_nodes(document, params.without);
  const std::vector<int> roots = root_nodes(document, parents);
  for (std::size_t i = 0; i < parents.size(); ++i) {
    scene.nodes.push_back(
        {document.model.nodes[i].name, parents[i], read_fiv_table(document, i), read_light_group(document, i)});
  }
  // visit(node, its transform, is it visible, is it left out), parents first; `file` is the transform of the file.
  const auto walk = [&](const M44d& file, const auto& visit) {
    std::vector<Open> open;
    for (auto root = roots.rbegin(); root != roots.rend(); ++root)
      open.push_back({std::size_t(*root), file, true, false});
    while (!open.empty()) {
      const Open current = open.back();
      open.pop_back();
      const M44d world = locals[current.node] * current.parent_world;
      const json* visibility = find_extension(element(document, "nodes", current.node), "KHR_node_visibility");
      const bool visible = current.visible && (visibility == nullptr || visibility->value("visible", true));
      const bool left_out = current.left_out || unwanted[current.node] != 0;
      visit(current.node, world, visible, left_out);
      const std::vector<int>& children = document.model.nodes[current.node].children;
      for (auto child = children.rbegin(); child != children.rend(); ++child)
        open.push_back({std::size_t(*child), world, visible, left_out});
    }
  };
  Placer placer(document, meshes, params, scene);
  M44d file;
  file.setScale(params.scale);
  walk(file, [&](std::size_t node, const M44d& world, bool visible, bool left_out) {
    placer.measure(node, file, world, visible, left_out);
  });
  scene.anchor_m = placer.choose_anchor();
  // Taken off at the root, where files have the offset, it leaves what hangs below in small numbers.
  for (int axis = 0; axis < 3; ++axis) file[3][axis] = -scene.anchor_m[axis] + 0.0;
  walk(file, [&](std::size_t node, const M44d& world, bool visible, bool left_out) {
    placer.place(node, file, world, visible, left_out);
  });
  placer.warn_of_unlit();
  return placer.left_out_materials();
}

}  // namespace ivory::gltf
