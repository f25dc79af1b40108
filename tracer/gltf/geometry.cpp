#include "tracer/gltf/geometry.h"

#include <array>
#include <cmath>

namespace ivory::gltf {
namespace {

using Triangle = Imath::Vec3<std::uint32_t>;

constexpr std::uint32_t unused = 0xFFFFFFFF;

// New vertex i is old vertex source[i].
template <class T>
void gather(std::vector<T>& values, const std::vector<std::uint32_t>& source) {
  if (values.empty()) return;
  std::vector<T> result;
  result.reserve(source.size());
  for (const std::uint32_t i : source) result.push_back(values[i]);
  values = std::move(result);
}

void gather_vertices(Mesh& mesh, const std::vector<std::uint32_t>& source) {
  gather(mesh.positions, source);
  gather(mesh.normals, source);
  gather(mesh.tangents, source);
  for (std::vector<V2f>& uv : mesh.uvs) gather(uv, source);
  gather(mesh.colors, source);
}

V3f area_vector(const Mesh& mesh, const Triangle& t) {
  const V3f& p = mesh.positions[t.x];
  return (mesh.positions[t.y] - p).cross(mesh.positions[t.z] - p);
}

}  // namespace

std::size_t drop_degenerate_triangles(Mesh& mesh) {
  return std::erase_if(mesh.triangles, [&mesh](const Triangle& t) {
    if (t.x == t.y || t.y == t.z || t.z == t.x) return true;
    const V3f a = area_vector(mesh, t);
    const float length2 = a.dot(a);
    return !(length2 > 0);
  });
}

void drop_unused_vertices(Mesh& mesh) {
  std::vector<std::uint32_t> target(mesh.positions.size(), unused);
  for (const Triangle& t : mesh.triangles) target[t.x] = target[t.y] = target[t.z] = 0;
  std::vector<std::uint32_t> source;
  source.reserve(mesh.positions.size());
  for (std::size_t i = 0; i < target.size(); ++i) {
    if (target[i] == unused) continue;
    target[i] = std::uint32_t(source.size());
    source.push_back(std::uint32_t(i));
  }
  if (source.size() == target.size()) return;
  gather_vertices(mesh, source);
  for (Triangle& t : mesh.triangles) t = Triangle(target[t.x], target[t.y], target[t.z]);
}

void make_flat_normals(Mesh& mesh) {
  std::vector<std::uint32_t> source;
  source.reserve(mesh.triangles.size() * 3);
  std::vector<V3f> normals;
  normals.reserve(mesh.triangles.size() * 3);
  for (Triangle& t : mesh.triangles) {
    const V3f ng = area_vector(mesh, t).normalized();
    normals.insert(normals.end(), 3, ng);
    const std::uint32_t first = std::uint32_t(source.size());
    source.insert(source.end(), {t.x, t.y, t.z});
    t = Triangle(first, first + 1, first + 2);
  }
  mesh.normals.clear();
  gather_vertices(mesh, source);
  mesh.normals = std::move(normals);
}

// A triangle with edges e1, e2 and uv edges (a, b), (c, d) has dp/du = (d e1 - b e2) / det and a
// bitangent on the side of the sign of det = a d - b c. glTF's bitangent is cross(n, t) w and points
// towards growing -v, v growing downwards in the image: "green up" maps need w = +1 where u runs
// right and v runs down on the front face, that is where det < 0.
// glTF recommends MikkTSpace, which no Debian package brings; the two differ where uv seams and normals split a vertex.
void generate_tangents(Mesh& mesh, const TextureUse& use) {
  const std::vector<V2f>& uvs = mesh.uvs[std::size_t(use.uv_set)];
  const auto& m = use.uv_transform;
  const auto transformed = [&](std::uint32_t i) {
    const V2f& uv = uvs[i];
    return V2f(m[0] * uv.x + m[1] * uv.y, m[3] * uv.x + m[4] * uv.y);
  };
  const std::size_t vertices = mesh.positions.size();
  std::array<std::vector<V3f>, 2> sums{std::vector<V3f>(vertices, V3f(0)), std::vector<V3f>(vertices, V3f(0))};
  std::array<std::vector<char>, 2> touched{std::vector<char>(vertices, 0), std::vector<char>(vertices, 0)};
  std::vector<unsigned char> side(mesh.triangles.size());
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const Triangle& t = mesh.triangles[k];
    const V3f e1 = mesh.positions[t.y] - mesh.positions[t.x];
    const V3f e2 = mesh.positions[t.z] - mesh.positions[t.x];
    const V2f d1 = transformed(t.y) - transformed(t.x);
    const V2f d2 = transformed(t.z) - transformed(t.x);
    const float det = d1.x * d2.y - d1.y * d2.x;
    side[k] = det < 0 ? 1 : 0;
    // Weighted by area as |e1 x e2| is in e1 d2 - e2 d1; the sign of det turns it towards growing u.
    V3f direction = (e1 * d2.y - e2 * d1.y) * (det < 0 ? -1.0F : 1.0F);
    const float length = direction.length();
    direction = length > 0 && std::isfinite(length) ? direction * (area_vector(mesh, t).length() / length) : V3f(0);
    for (const std::uint32_t corner : {t.x, t.y, t.z}) {
      sums[std::size_t(side[k])][corner] += direction;
      touched[std::size_t(side[k])][corner] = 1;
    }
  }

  // A vertex of triangles of both orientations keeps the first and gets a twin for the second.
  std::vector<std::uint32_t> source(vertices);
  std::vector<std::uint32_t> twin(vertices, unused);
  std::vector<unsigned char> side_of(vertices, 0);
  for (std::size_t i = 0; i < vertices; ++i) {
    source[i] = std::uint32_t(i);
    side_of[i] = touched[0][i] != 0 ? 0 : 1;
  }
  for (std::size_t i = 0; i < vertices; ++i) {
    if (touched[0][i] == 0 || touched[1][i] == 0) continue;
    twin[i] = std::uint32_t(source.size());
    source.push_back(std::uint32_t(i));
    side_of.push_back(1);
  }
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    if (side[k] == 0) continue;
    Triangle& t = mesh.triangles[k];
    for (int c = 0; c < 3; ++c)
      if (twin[t[c]] != unused) t[c] = twin[t[c]];
  }
  gather_vertices(mesh, source);

  mesh.tangents.resize(source.size());
  for (std::size_t i = 0; i < source.size(); ++i) {
    const V3f& n = mesh.normals[i];
    V3f t = sums[std::size_t(side_of[i])][source[i]];
    t -= n * n.dot(t);
    const float length = t.length();
    if (length > 0 && std::isfinite(length)) {
      t /= length;
    } else {  // no uv extent: any direction across the normal
      t = (std::abs(n.x) < 0.9F ? V3f(1, 0, 0) : V3f(0, 1, 0)).cross(n).normalized();
    }
    mesh.tangents[i] = V4f(t.x, t.y, t.z, side_of[i] != 0 ? 1.0F : -1.0F);
  }
}

}  // namespace ivory::gltf
