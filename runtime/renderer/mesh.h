// Triangles on the GPU.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "grid/base/types.h"
#include "runtime/gl/gl.h"

namespace ivory {

// Of one mesh; arrays but positions and triangles may be empty, others have one entry a vertex.
struct MeshData {
  std::span<const V3f> positions;  // m
  std::span<const V3f> normals;
  std::span<const V4f> tangents;  // w: sign of the bitangent
  std::span<const V2f> uv0;
  std::span<const V2f> uv1;
  std::span<const V4f> colors;  // linear RGBA
  std::span<const Imath::Vec3<std::uint32_t>> triangles;
};

struct GpuMesh {
  gl::VertexArray vertex_array;
  gl::Buffer vertices;
  gl::Buffer indices;
  int index_count = 0;
  bool has_normals = false;   // otherwise shaded flat
  bool has_tangents = false;  // otherwise not normal-mapped
  Box3f bounds;               // of the positions
  std::size_t size_bytes = 0;

  std::size_t bytes() const { return size_bytes; }
};

// Throws Error (naming `what`) for no triangles, for indices beyond the vertices and for memory that runs out.
GpuMesh upload(const std::string& what, const MeshData& data);

}  // namespace ivory
