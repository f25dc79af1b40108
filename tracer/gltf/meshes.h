// Primitives to triangle meshes. Private to the loader.
#pragma once

#include "tracer/core/scene.h"
#include "tracer/gltf/document.h"

namespace ivory::gltf {

struct MeshSet {
  std::vector<Mesh> meshes;
  std::vector<std::vector<int>> of_mesh;  // [glTF mesh] -> indices into `meshes`, one a primitive with triangles
};

// All primitives of the file that make triangles. Materials whose textures need coordinates that a
// primitive lacks are copied without them (appended to `materials`).
MeshSet make_meshes(Document& document, std::vector<Material>& materials);

}  // namespace ivory::gltf
