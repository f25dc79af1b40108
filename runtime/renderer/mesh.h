// Triangles on the GPU.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "grid/base/types.h"
#include "runtime/gl/gl.h"

namespace ivory {

// One mesh in its own space. Arrays have one entry per vertex; all but positions and triangles may be empty.
struct MeshData {
  std::span<const V3f> positions;  // m
  std::span<const V3f> normals;    // unit
  std::span<const V4f> tangents;   // unit xyz; w, +1 or -1: sign of the bitangent
  std::span<const V2f> uv0;        // as glTF has them: v grows downwards
  std::span<const V2f> uv1;
  std::span<const V4f> colors;                            // linear RGBA, times the material's
  std::span<const Imath::Vec3<std::uint32_t>> triangles;  // indices of vertices, counter-clockwise from the front
};

struct GpuMesh {
  gl::VertexArray vertex_array;
  gl::Buffer vertices;
  gl::Buffer indices;
  int index_count = 0;
  bool has_normals = false;   // else shaded flat
  bool has_tangents = false;  // else not normal-mapped
  Box3f bounds;               // of the positions
  std::size_t size_bytes = 0;

  std::size_t bytes() const { return size_bytes; }
};

// Needs a current context. Throws Error naming `what` for no triangles, for indices beyond the vertices and where
// memory runs out.
GpuMesh upload(const MeshData& data, const std::string& what = "mesh");

// The same mesh in another pose: as many vertices and triangles, and normals and tangents where it had them. Throws
// Error naming `what` where that is not so.
void update(GpuMesh& mesh, const MeshData& data, const std::string& what = "mesh");

}  // namespace ivory
