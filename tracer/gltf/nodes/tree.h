// The node tree of a file: who hangs below whom, and every node's own transform. Private to the loader.
#pragma once

#include <string>
#include <vector>

#include <ImathMatrix.h>
#include <ImathQuat.h>

#include "grid/base/types.h"
#include "tracer/gltf/document.h"

namespace ivory::gltf {

// "nodes[3] 'wall'"
std::string node_label(const Document& document, std::size_t node);

// Scale, then rotation, then translation, for row vectors.
Imath::M44d trs_matrix(const V3d& translation, Imath::Quatd rotation, const V3d& scale);

// The rotation; throws Error (naming `what`) where it is not of unit length to a percent.
Imath::Quatd checked_rotation(const Document& document, const std::string& what, double x, double y, double z,
                              double w);

// The node's transform to its parent. Throws Error for one that is not affine, and for a matrix beside translation,
// rotation or scale.
Imath::M44d local_matrix(const Document& document, std::size_t node);

// [node] its parent, or no_index. Throws Error for nodes with two parents and for loops.
std::vector<int> find_parents(const Document& document);

// [node] its transform to the world, through all nodes above it. Throws Error as find_parents() and local_matrix() do.
std::vector<Imath::M44d> world_matrices(const Document& document);

// [node] is it called by one of these names? A text that names none may be a node's index. Throws ParameterError
// ("without") for texts that are neither.
std::vector<char> find_nodes(const Document& document, const std::vector<std::string>& names);

// The nodes of the default scene; of the first where the file names none; all without a parent, with a warning, where
// it has no scene. Throws Error for scenes that list a node twice or one that is a child.
std::vector<int> root_nodes(Document& document, const std::vector<int>& parents);

}  // namespace ivory::gltf
