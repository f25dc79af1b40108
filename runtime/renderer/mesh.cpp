#include "runtime/renderer/mesh.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "runtime/gl/check.h"

namespace ivory {

namespace {

struct Vertex {
  V3f position;
  V3f normal;
  V4f tangent{0, 0, 0, 1};
  V4f uv{0, 0, 0, 0};  // set 0, set 1
  V4f color{1, 1, 1, 1};
};
static_assert(sizeof(Vertex) == 18 * sizeof(float));

void check(const MeshData& data, const std::string& what) {
  if (data.triangles.empty() || data.positions.empty()) throw Error(what, "the mesh has no triangles", "leave it out");
  if (data.triangles.size() > std::size_t(std::numeric_limits<int>::max()) / 3)
    throw Error(what, "the mesh has too many triangles for one draw call", "split it");
  for (const auto& t : data.triangles) {
    const std::size_t largest = std::max({t.x, t.y, t.z});
    if (largest < data.positions.size()) continue;
    throw Error(what, fmt::format("a triangle names vertex {} of {}", largest, data.positions.size()),
                "mend its indices");
  }
}

std::vector<Vertex> interleave(const MeshData& data) {
  std::vector<Vertex> vertices(data.positions.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    Vertex& v = vertices[i];
    v.position = data.positions[i];
    if (!data.normals.empty()) v.normal = data.normals[i];
    if (!data.tangents.empty()) v.tangent = data.tangents[i];
    if (!data.uv0.empty()) v.uv.x = data.uv0[i].x, v.uv.y = data.uv0[i].y;
    if (!data.uv1.empty()) v.uv.z = data.uv1[i].x, v.uv.w = data.uv1[i].y;
    if (!data.colors.empty()) v.color = data.colors[i];
  }
  return vertices;
}

void attribute(GLuint index, int components, std::size_t offset) {
  IVORY_GL(glEnableVertexAttribArray, index);
  IVORY_GL(glVertexAttribPointer, index, components, GL_FLOAT, GLboolean(GL_FALSE), GLsizei(sizeof(Vertex)),
           reinterpret_cast<const void*>(offset));  // NOLINT(performance-no-int-to-ptr): so OpenGL takes an offset
}

}  // namespace

GpuMesh upload(const MeshData& data, const std::string& what) {
  gl::require_context();
  check(data, what);
  const std::vector<Vertex> vertices = interleave(data);
  GpuMesh mesh;
  mesh.vertex_array = gl::make<gl::Kind::vertex_array>();
  mesh.vertices = gl::make<gl::Kind::buffer>();
  mesh.indices = gl::make<gl::Kind::buffer>();
  IVORY_GL(glBindVertexArray, mesh.vertex_array.id());
  IVORY_GL(glBindBuffer, GL_ARRAY_BUFFER, mesh.vertices.id());
  IVORY_GL(glBufferData, GL_ARRAY_BUFFER, GLsizeiptr(vertices.size() * sizeof(Vertex)), vertices.data(),
           GL_STATIC_DRAW);
  IVORY_GL(glBindBuffer, GL_ELEMENT_ARRAY_BUFFER, mesh.indices.id());
  IVORY_GL(glBufferData, GL_ELEMENT_ARRAY_BUFFER, GLsizeiptr(data.triangles.size_bytes()), data.triangles.data(),
           GL_STATIC_DRAW);
  attribute(0, 3, offsetof(Vertex, position));
  attribute(1, 3, offsetof(Vertex, normal));
  attribute(2, 4, offsetof(Vertex, tangent));
  attribute(3, 4, offsetof(Vertex, uv));
  attribute(4, 4, offsetof(Vertex, color));
  IVORY_GL(glBindVertexArray, 0);
  mesh.index_count = int(3 * data.triangles.size());
  mesh.has_normals = !data.normals.empty();
  mesh.has_tangents = mesh.has_normals && !data.tangents.empty();
  for (const V3f& p : data.positions) mesh.bounds.extendBy(p);
  mesh.size_bytes = vertices.size() * sizeof(Vertex) + data.triangles.size_bytes();
  return mesh;
}

void update(GpuMesh& mesh, const MeshData& data, const std::string& what) {
  gl::require_context();
  const std::size_t bytes = data.positions.size() * sizeof(Vertex);
  if (mesh.size_bytes != bytes + data.triangles.size_bytes() || mesh.index_count != int(3 * data.triangles.size()) ||
      mesh.has_normals != !data.normals.empty() || mesh.has_tangents != (mesh.has_normals && !data.tangents.empty()))
    throw Error(what, "the mesh has other vertices than the one that it poses", "upload it as another");
  const std::vector<Vertex> vertices = interleave(data);
  IVORY_GL(glBindBuffer, GL_ARRAY_BUFFER, mesh.vertices.id());
  // As a whole, so that drawing of the last pose need not be waited for.
  IVORY_GL(glBufferData, GL_ARRAY_BUFFER, GLsizeiptr(bytes), vertices.data(), GL_DYNAMIC_DRAW);
  mesh.bounds.makeEmpty();
  for (const V3f& p : data.positions) mesh.bounds.extendBy(p);
}

}  // namespace ivory
