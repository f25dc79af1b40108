// Morph targets: displacements of vertices, in shares. Private to the loader.
#pragma once

#include <span>

#include "tracer/core/scene.h"
#include "tracer/gltf/attributes.h"

namespace ivory::gltf {

// Adds the primitive's displacements of positions, normals and tangents, each target's times its weight (those without
// one count as 0), to `mesh`, whose vertices are those of attributes.range. Throws Error for displacements of another
// number of vertices, and where a vertex leaves what a float can hold; warns of what is not displaced.
void apply_morphs(Document& document, const Attributes& attributes, std::span<const double> weights, Mesh& mesh);

}  // namespace ivory::gltf
