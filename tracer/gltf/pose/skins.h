// Skins: meshes whose vertices follow joints. Private to the loader.
#pragma once

#include <optional>
#include <vector>

#include <ImathMatrix.h>

#include "tracer/core/scene.h"
#include "tracer/gltf/attributes.h"

namespace ivory::gltf {

// The joints of a skin where their nodes stand. A skinned mesh is posed by them alone: its own node's transform, and
// those above it, do not count (glTF 2.0, 3.7.3.3).
struct Skin {
  std::string what;
  V3d origin{0, 0, 0};                 // world: the first joint's place
  std::vector<Imath::M44d> from_mesh;  // [joint] p_world - origin = p_mesh * from_mesh
  std::vector<char> has_inverse;       // [joint] can its inverse bind matrix be one?
};

// The file's skin of that index. `to_world` has every node's transform. Throws Error for inverse bind matrices that are
// too few, of another type, or not affine.
Skin make_skin(const Document& document, std::size_t index, const std::vector<Imath::M44d>& to_world);

bool is_skinned(const Attributes& attributes);

// Moves positions, normals and tangents of a primitive that is_skinned() to where the joints have them, less
// skin.origin. Throws Error for joints that the skin lacks or whose inverse bind matrix is singular, sets of joints
// without weights, and component types that glTF does not allow; warns of weights that had to be mended.
void apply_skin(Document& document, const Attributes& attributes, const Skin& skin, Mesh& mesh);

}  // namespace ivory::gltf
