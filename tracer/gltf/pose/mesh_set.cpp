// Which nodes share a mesh, and which show one in a pose of their own.
#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "grid/base/memory.h"
#include "tracer/gltf/materials.h"
#include "tracer/gltf/meshes.h"
#include "tracer/gltf/nodes/tree.h"
#include "tracer/gltf/pose/skins.h"

namespace ivory::gltf {
namespace {

class Maker {
 public:
  Maker(Document& document, std::vector<Material>& materials)
      : document_(document), materials_(materials), default_material_(int(materials.size()) - 1) {}

  // In the pose that the mesh itself stores; those that no node shows too, so that a broken one is found.
  void add_meshes() {
    const std::size_t count = document_.model.meshes.size();
    std::vector<char> needed(count, 1);
    for (const tinygltf::Node& node : document_.model.nodes)
      if (node.mesh >= 0 && is_posed(node)) needed[std::size_t(node.mesh)] = 0;
    for (const tinygltf::Node& node : document_.model.nodes)
      if (node.mesh >= 0 && !is_posed(node)) needed[std::size_t(node.mesh)] = 1;
    for (std::size_t m = 0; m < count; ++m)
      of_mesh_.push_back(needed[m] != 0 ? add(m, {document_.model.meshes[m].weights}) : std::vector<int>{});
  }

  void add_nodes() {
    check_posed();
    for (std::size_t n = 0; n < document_.model.nodes.size(); ++n) {
      const tinygltf::Node& node = document_.model.nodes[n];
      set_.of_node.push_back(node.mesh < 0 ? std::vector<int>{} : shown_by(node));
    }
  }

  MeshSet take() { return std::move(set_); }

 private:
  std::vector<int> add(std::size_t mesh, const Pose& pose) {
    std::vector<int> indices;
    for (std::size_t p = 0; p < document_.model.meshes[mesh].primitives.size(); ++p) {
      std::optional<PosedMesh> made = make_mesh(document_, mesh, p, pose, materials_, default_material_);
      if (!made) continue;
      indices.push_back(int(set_.meshes.size()));
      set_.meshes.push_back(std::move(made->mesh));
      set_.world_origin.push_back(made->skinned && pose.skin ? std::optional(pose.skin->origin) : std::nullopt);
      const int material = document_.model.meshes[mesh].primitives[p].material;
      set_.unlit.push_back(is_unlit(document_, material) ? material : no_index);
    }
    return indices;
  }

  std::vector<int> shown_by(const tinygltf::Node& node) {
    if (!is_posed(node)) return of_mesh_[std::size_t(node.mesh)];
    const PoseKey key = key_of(node);
    const auto known = posed_.find(key);
    if (known != posed_.end()) return known->second;
    const Pose pose{std::get<2>(key), node.skin < 0 ? nullptr : &skin(std::size_t(node.skin))};
    return posed_[key] = add(std::size_t(node.mesh), pose);
  }

  // The mesh, the skin or no_index, and the weights that a node shows.
  using PoseKey = std::tuple<int, int, std::vector<double>>;

  bool is_posed(const tinygltf::Node& node) const {
    return node.skin >= 0 ||
           (!node.weights.empty() && node.weights != document_.model.meshes[std::size_t(node.mesh)].weights);
  }

  PoseKey key_of(const tinygltf::Node& node) const {
    return {node.mesh, node.skin,
            node.weights.empty() ? document_.model.meshes[std::size_t(node.mesh)].weights : node.weights};
  }

  // A few bytes of file may ask for any number of poses of a large mesh.
  void check_posed() const {
    std::set<PoseKey> keys;
    double bytes = 0;
    for (const tinygltf::Node& node : document_.model.nodes) {
      if (node.mesh < 0 || !is_posed(node) || !keys.insert(key_of(node)).second) continue;
      for (const tinygltf::Primitive& primitive : document_.model.meshes[std::size_t(node.mesh)].primitives) {
        const auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end()) continue;
        const auto count = [&](int accessor) { return double(document_.model.accessors[std::size_t(accessor)].count); };
        const double vertices = count(position->second);
        const double corners = primitive.indices >= 0 ? count(primitive.indices) : vertices;
        const double triangles = primitive.mode == TINYGLTF_MODE_TRIANGLES ? corners / 3 : corners;
        bytes += std::min(vertices, corners) * bytes_per_vertex + triangles * bytes_per_triangle;
      }
    }
    check_memory(document_.path, bytes, "pose fewer meshes by skins and morph weights of their own");
  }

  const Skin& skin(std::size_t index) {
    if (to_world_.empty()) to_world_ = world_matrices(document_);
    const auto known = skins_.find(index);
    return known != skins_.end() ? known->second
                                 : skins_.emplace(index, make_skin(document_, index, to_world_)).first->second;
  }

  Document& document_;
  std::vector<Material>& materials_;
  int default_material_;
  MeshSet set_;
  std::vector<std::vector<int>> of_mesh_;
  std::map<PoseKey, std::vector<int>> posed_;
  std::vector<Imath::M44d> to_world_;  // [node], once a skin asks for it
  std::map<std::size_t, Skin> skins_;
};

}  // namespace

MeshSet make_meshes(Document& document, std::vector<Material>& materials) {
  Maker maker(document, materials);
  maker.add_meshes();
  maker.add_nodes();
  return maker.take();
}

}  // namespace ivory::gltf
