#include "tracer/gltf/meshes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tracer/gltf/attributes.h"
#include "tracer/gltf/geometry.h"
#include "tracer/gltf/materials.h"
#include "tracer/gltf/pose/morphs.h"
#include "tracer/gltf/pose/skins.h"

namespace ivory::gltf {
namespace {

using nlohmann::json;
using Triangle = Imath::Vec3<std::uint32_t>;

// Squares of products of coordinates stay within float.
constexpr float max_coordinate_m = 1e9F;

bool is_integer(int type) { return type != TINYGLTF_COMPONENT_TYPE_FLOAT; }
bool is_unsigned_small(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
}

// glTF 2.0, section 3.7.2.1, and KHR_mesh_quantization: floats, or integers of 8 and 16 bits.
void check_format(const Attributes& attributes, const std::string& name) {
  const tinygltf::Accessor& accessor = attributes.accessor(name);
  const int type = accessor.componentType;
  bool good = type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (name == "NORMAL" || name == "TANGENT")
    good &= !is_integer(type) || (accessor.normalized && !is_unsigned_small(type));
  if (name == "COLOR_0") good &= !is_integer(type) || (accessor.normalized && is_unsigned_small(type));
  if (!good) {
    attributes.document.fail(fmt::format("{} has {} in component type {}{}", attributes.what, name, type,
                                         accessor.normalized ? " (normalized)" : ""),
                             remedy);
  }
}

// glTF 2.0, section 3.7.2.1: the corners of triangle i of strips and fans.
std::vector<Triangle> triangulate(const std::vector<std::uint32_t>& v, int mode) {
  std::vector<Triangle> triangles;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    triangles.reserve(v.size() / 3);
    for (std::size_t i = 0; i + 2 < v.size(); i += 3) triangles.emplace_back(v[i], v[i + 1], v[i + 2]);
  } else if (v.size() >= 3) {
    triangles.reserve(v.size() - 2);
    for (std::size_t i = 0; i + 2 < v.size(); ++i) {
      if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
        triangles.emplace_back(v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]);
      } else {
        triangles.emplace_back(v[i + 1], v[i + 2], v[0]);
      }
    }
  }
  return triangles;
}

void read_triangles(Document& document, Attributes& attributes, int mode, Mesh& mesh) {
  const std::size_t vertices = attributes.accessor("POSITION").count;
  std::vector<std::uint32_t> indices;
  if (attributes.draco) {
    // Draco's own triangles, whatever mode the primitive was before compression (the extension
    // allows strips, which then only say how the triangles were stored).
    indices = attributes.draco->indices();
    if (attributes.draco->vertex_count() != vertices) {
      document.fail(fmt::format("{} has {} vertices in its Draco data but accessors of {}", attributes.what,
                                attributes.draco->vertex_count(), vertices),
                    remedy);
    }
    mode = TINYGLTF_MODE_TRIANGLES;
  } else if (attributes.primitive.indices >= 0) {
    indices = read_indices(document, attributes.primitive.indices, attributes.what + " indices");
  } else {
    indices.resize(vertices);
    for (std::size_t i = 0; i < vertices; ++i) indices[i] = std::uint32_t(i);
  }
  for (const std::uint32_t index : indices) {
    if (index >= vertices)
      document.fail(fmt::format("{} has index {} but {} vertices", attributes.what, index, vertices), remedy);
  }
  if (mode == TINYGLTF_MODE_TRIANGLES && indices.size() % 3 != 0)
    document.warn(fmt::format("{} ends with a part of a triangle, which is dropped", attributes.what));
  if (!attributes.draco && !indices.empty()) {
    const auto [low, high] = std::minmax_element(indices.begin(), indices.end());
    attributes.range = {*low, std::size_t(*high) - *low + 1};
    for (std::uint32_t& index : indices) index -= std::uint32_t(attributes.range.first);
  }
  mesh.triangles = triangulate(indices, mode);
}

void check_positions(const Document& document, const Attributes& attributes, const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const V3f& p = mesh.positions[i];
    const bool good =
        std::abs(p.x) <= max_coordinate_m && std::abs(p.y) <= max_coordinate_m && std::abs(p.z) <= max_coordinate_m;
    if (!good) {
      document.fail(fmt::format("{} has vertex {} farther out than {} m", attributes.what, i, max_coordinate_m),
                    "scale the model down");
    }
  }
}

// Vectors that should have unit length, at least as far as interpolation needs it. Those without
// any length are replaced by the first triangle's normal, or any direction across for tangents.
void normalise(Document& document, const Attributes& attributes, Mesh& mesh) {
  std::size_t zero_normals = 0;
  std::vector<char> missing(mesh.normals.size(), 0);
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    V3f& n = mesh.normals[i];
    const double length = std::sqrt(double(n.x) * n.x + double(n.y) * n.y + double(n.z) * n.z);
    if (length > 1e-12) {
      n = V3f(float(n.x / length), float(n.y / length), float(n.z / length));
    } else {
      missing[i] = 1;
      ++zero_normals;
    }
  }
  if (zero_normals > 0) {
    for (const Triangle& t : mesh.triangles) {
      const V3f ng = (mesh.positions[t.y] - mesh.positions[t.x]).cross(mesh.positions[t.z] - mesh.positions[t.x]);
      for (const std::uint32_t corner : {t.x, t.y, t.z}) {
        if (missing[corner] == 0) continue;
        mesh.normals[corner] = ng.normalized();
        missing[corner] = 0;
      }
    }
    for (std::size_t i = 0; i < missing.size(); ++i)
      if (missing[i] != 0) mesh.normals[i] = V3f(0, 1, 0);
    document.warn(
        fmt::format("{} has {} normals without length; taken from a triangle", attributes.what, zero_normals));
  }

  std::size_t zero_tangents = 0;
  for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
    V4f& t = mesh.tangents[i];
    const V3f n = mesh.normals[i];
    V3f direction(t.x, t.y, t.z);
    direction -= n * n.dot(direction);
    const float length = direction.length();
    if (length > 1e-6F * V3f(t.x, t.y, t.z).length() && length > 0) {
      direction /= length;
    } else {
      direction = (std::abs(n.x) < 0.9F ? V3f(1, 0, 0) : V3f(0, 1, 0)).cross(n).normalized();
      ++zero_tangents;
    }
    t = V4f(direction.x, direction.y, direction.z, t.w < 0 ? -1.0F : 1.0F);
  }
  if (zero_tangents > 0)
    document.warn(fmt::format("{} has {} tangents without length or along the normal", attributes.what, zero_tangents));
}

void read_colors(Document& document, const Attributes& attributes, Mesh& mesh) {
  if (attributes.accessor("COLOR_0").type == TINYGLTF_TYPE_VEC3) {
    const std::vector<V3f> rgb = attributes.read<V3f, 3>("COLOR_0");
    mesh.colors.reserve(rgb.size());
    for (const V3f& c : rgb) mesh.colors.emplace_back(c.x, c.y, c.z, 1.0F);
  } else {
    mesh.colors = attributes.read<V4f, 4>("COLOR_0");
  }
  std::size_t outside = 0;
  for (V4f& c : mesh.colors) {
    const V4f inside(std::clamp(c.x, 0.0F, 1.0F), std::clamp(c.y, 0.0F, 1.0F), std::clamp(c.z, 0.0F, 1.0F),
                     std::clamp(c.w, 0.0F, 1.0F));
    if (inside != c) ++outside;
    c = inside;
  }
  if (outside > 0)
    document.warn(fmt::format("{} has {} vertex colours outside 0 to 1, which are clamped", attributes.what, outside));
}

// Coordinates for the material's textures. A use whose set the primitive lacks is dropped from a
// copy of the material.
void read_uvs(Document& document, const Attributes& attributes, std::vector<Material>& materials, Mesh& mesh) {
  std::set<int> wanted;
  std::set<int> lacking;
  for (const auto slot : texture_slots) {
    const TextureUse& use = materials[std::size_t(mesh.material)].*slot;
    if (use.texture == no_index) continue;
    (attributes.has(fmt::format("TEXCOORD_{}", use.uv_set)) ? wanted : lacking).insert(use.uv_set);
  }
  for (const int set : document.uv_sets)
    if (attributes.has(fmt::format("TEXCOORD_{}", set))) wanted.insert(set);
  for (const int set : wanted) {
    const std::string name = fmt::format("TEXCOORD_{}", set);
    check_format(attributes, name);
    if (std::size_t(set) >= mesh.uvs.size()) mesh.uvs.resize(std::size_t(set) + 1);
    mesh.uvs[std::size_t(set)] = attributes.read<V2f, 2>(name);
  }
  if (lacking.empty()) return;
  Material reduced = materials[std::size_t(mesh.material)];
  document.warn(fmt::format("{} lacks TEXCOORD_{}, which textures of material '{}' need; they are left out",
                            attributes.what, *lacking.begin(), reduced.name));
  for (const auto slot : texture_slots) {
    if (lacking.contains((reduced.*slot).uv_set)) reduced.*slot = {};
  }
  mesh.material = int(materials.size());
  materials.push_back(std::move(reduced));
}

}  // namespace

std::optional<PosedMesh> make_mesh(Document& document, std::size_t mesh_index, std::size_t primitive_index,
                                   const Pose& pose, std::vector<Material>& materials, int default_material) {
  const tinygltf::Mesh& source = document.model.meshes[mesh_index];
  const tinygltf::Primitive& primitive = source.primitives[primitive_index];
  const std::string what = label("meshes", mesh_index, source.name) + fmt::format(" primitive {}", primitive_index);
  const int mode = primitive.mode;
  if (mode < TINYGLTF_MODE_TRIANGLES) {
    document.warn(what + (mode == TINYGLTF_MODE_POINTS ? " is made of points" : " is made of lines") +
                  ", which are left out");
    return std::nullopt;
  }
  Attributes attributes{document, primitive, std::nullopt, what};
  if (!attributes.has("POSITION")) {
    document.warn(what + " has no POSITION and is left out");
    return std::nullopt;
  }
  const json& extensions = element(document, "meshes", mesh_index)["primitives"][primitive_index];
  if (const json* draco = find_extension(extensions, "KHR_draco_mesh_compression"))
    attributes.draco.emplace(document, *draco, primitive, what);

  Mesh mesh;
  mesh.name = source.name.empty() ? fmt::format("meshes[{}]", mesh_index) : source.name;
  mesh.material = primitive.material >= 0 ? primitive.material : default_material;
  check_format(attributes, "POSITION");
  read_triangles(document, attributes, mode, mesh);
  mesh.positions = attributes.read<V3f, 3>("POSITION");
  if (attributes.has("NORMAL")) {
    check_format(attributes, "NORMAL");
    mesh.normals = attributes.read<V3f, 3>("NORMAL");
  }
  if (attributes.has("COLOR_0")) {
    check_format(attributes, "COLOR_0");
    read_colors(document, attributes, mesh);
  }
  read_uvs(document, attributes, materials, mesh);
  const TextureUse normal_use = materials[std::size_t(mesh.material)].normal_texture;
  const bool normal_mapped = normal_use.texture != no_index;
  // "When normals are not specified, the provided tangents (if present) MUST be ignored."
  if (normal_mapped && attributes.has("TANGENT") && !mesh.normals.empty()) {
    check_format(attributes, "TANGENT");
    mesh.tangents = attributes.read<V4f, 4>("TANGENT");
  }
  apply_morphs(document, attributes, pose.weights, mesh);
  const bool skinned = pose.skin != nullptr && is_skinned(attributes);
  if (skinned) apply_skin(document, attributes, *pose.skin, mesh);
  if (pose.skin != nullptr && !skinned)
    document.warn(what + " is shown with a skin but has no joints; its node's transform places it");
  check_positions(document, attributes, mesh);

  const std::size_t dropped = drop_degenerate_triangles(mesh);
  if (dropped > 0) document.warn(fmt::format("{} has {} triangles without area, which are left out", what, dropped));
  if (mesh.triangles.empty()) {
    document.warn(what + " has no triangles and is left out");
    return std::nullopt;
  }
  drop_unused_vertices(mesh);
  normalise(document, attributes, mesh);
  if (normal_mapped && mesh.tangents.empty()) {
    if (mesh.normals.empty()) make_flat_normals(mesh);
    generate_tangents(mesh, normal_use);
  }
  return PosedMesh{std::move(mesh), skinned};
}

}  // namespace ivory::gltf
