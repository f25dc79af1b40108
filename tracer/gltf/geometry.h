// Mending meshes: degenerate triangles, normals and tangents. Private to the loader.
#pragma once

#include "tracer/core/scene.h"

namespace ivory::gltf {

// Drops triangles without area (as far as float can tell) and then vertices that no triangle uses.
// Returns how many triangles went.
std::size_t drop_degenerate_triangles(Mesh& mesh);
void drop_unused_vertices(Mesh& mesh);

// Per-vertex tangents from the derivatives of the uv that `use` (a normal texture) sees. Vertices
// that triangles of both uv orientations share are split. Needs normals.
void generate_tangents(Mesh& mesh, const TextureUse& use);
// Gives every triangle vertices and a normal of its own.
void make_flat_normals(Mesh& mesh);

}  // namespace ivory::gltf
