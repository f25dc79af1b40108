// Primitives to triangle meshes. Private to the loader.
#pragma once

#include <optional>
#include <vector>

#include "tracer/core/scene.h"
#include "tracer/gltf/document.h"

namespace ivory::gltf {

// Of a mesh of its own: what scene.h stores for a vertex with two sets of coordinates, and Embree's copy and hierarchy.
inline constexpr double bytes_per_vertex = 88;
inline constexpr double bytes_per_triangle = 96;

struct Skin;

// How a node shows a mesh.
struct Pose {
  const std::vector<double>& weights;  // of its morph targets
  const Skin* skin = nullptr;          // null: it is rigid
};

struct PosedMesh {
  Mesh mesh;
  bool skinned = false;  // are its vertices in the world's axes, about skin->origin?
};

// One primitive of a mesh of the file; nothing where it makes no triangles. Materials whose textures need coordinates
// that it lacks are copied without them (appended to `materials`).
std::optional<PosedMesh> make_mesh(Document& document, std::size_t mesh_index, std::size_t primitive_index,
                                   const Pose& pose, std::vector<Material>& materials, int default_material);

struct MeshSet {
  std::vector<Mesh> meshes;
  std::vector<std::vector<int>> of_node;  // [node] -> indices into `meshes`, one a primitive with triangles
  // [mesh] of skinned ones: their vertices are in the world's axes, about this point of it, whatever the node's
  // transform.
  std::vector<std::optional<V3d>> world_origin;
  std::vector<int> unlit;  // [mesh] the file's material where that is_unlit(), else no_index
};

// All primitives of the file that make triangles. Nodes share them, but for those that pose them in their own way: by
// weights of their own, or by a skin. `materials` as make_mesh() has them; the last is the default. In
// pose/mesh_set.cpp.
MeshSet make_meshes(Document& document, std::vector<Material>& materials);

}  // namespace ivory::gltf
