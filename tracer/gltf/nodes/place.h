// The node tree to instances, cameras and lights. Private to the loader.
#pragma once

#include "tracer/core/scene.h"
#include "tracer/gltf/document.h"
#include "tracer/gltf/loader.h"
#include "tracer/gltf/meshes.h"

namespace ivory::gltf {

// Walks the default scene (the first where the file names none; all root nodes where it has none)
// and fills scene.instances, cameras and lights. Throws Error for cycles, nodes with two parents,
// scenes that list a node which is not a root, and transforms that are not finite. Sets scene.anchor_m first, and
// places all relative to it. A mesh that its node flattens is copied in the scene's space, appended to scene.meshes.
// Returns for each material whether nodes show it that params.without leaves out: its images are part of the scene's
// content all the same.
std::vector<char> place_nodes(Document& document, const MeshSet& meshes, const LoadParams& params, Scene& scene);

}  // namespace ivory::gltf
