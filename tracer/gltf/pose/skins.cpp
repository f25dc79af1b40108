#include "tracer/gltf/pose/skins.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace ivory::gltf {
namespace {

using Imath::M44d;
using nlohmann::json;

V3d row(const M44d& m, int i) { return {m[i][0], m[i][1], m[i][2]}; }

// Of its volume against that of a box with its sides: rounding to float leaves 1e-7.
bool is_singular(const M44d& m) {
  const double sides = row(m, 0).length() * row(m, 1).length() * row(m, 2).length();
  return !(std::abs(row(m, 0).cross(row(m, 1)).dot(row(m, 2))) > 1e-7 * sides);
}

// JOINTS_n and WEIGHTS_n of one n.
struct Influences {
  std::vector<V4f> joints;  // whole numbers
  std::vector<V4f> weights;
};

Influences read_influences(const Document& document, const Attributes& attributes, int set) {
  const std::string joints = fmt::format("JOINTS_{}", set);
  const std::string weights = fmt::format("WEIGHTS_{}", set);
  if (!attributes.has(weights))
    document.fail(fmt::format("{} has {} but no {}", attributes.what, joints, weights), remedy);
  const auto check = [&](const std::string& name, bool good) {
    const tinygltf::Accessor& accessor = attributes.accessor(name);
    if (!good) {
      document.fail(fmt::format("{} has {} in component type {}{}", attributes.what, name, accessor.componentType,
                                accessor.normalized ? " (normalized)" : ""),
                    remedy);
    }
  };
  const auto is_small = [](int type) {
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
  };
  const tinygltf::Accessor& j = attributes.accessor(joints);
  const tinygltf::Accessor& w = attributes.accessor(weights);
  check(joints, is_small(j.componentType) && !j.normalized);
  check(weights, w.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT || (is_small(w.componentType) && w.normalized));
  return {attributes.read<V4f, 4>(joints), attributes.read<V4f, 4>(weights)};
}

struct Tally {
  std::size_t negative = 0;
  std::size_t unbound = 0;
  std::size_t scaled = 0;
};

// The vertex' transform: the joints' matrices in the shares of its weights.
M44d blend(const Document& document, const Attributes& attributes, const Skin& skin,
           const std::vector<Influences>& sets, std::size_t vertex, Tally& tally) {
  M44d sum(0.0);
  double total = 0;
  bool negative = false;
  const auto add = [&](float joint_number, double weight) {
    if (!(joint_number >= 0 && joint_number < float(skin.from_mesh.size()))) {
      document.fail(fmt::format("{} has vertex {} on joint {} of {}, which has {}", attributes.what, vertex,
                                joint_number, skin.what, skin.from_mesh.size()),
                    remedy);
    }
    const auto joint = std::size_t(joint_number);
    if (skin.has_inverse[joint] == 0) {
      document.fail(fmt::format("{} has inverse bind matrix {}, which has no inverse itself", skin.what, joint),
                    remedy);
    }
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) sum[i][k] += weight * skin.from_mesh[joint][i][k];
    total += weight;
  };
  for (const Influences& set : sets) {
    for (int k = 0; k < 4; ++k) {
      const float weight = set.weights[vertex][k];
      negative |= weight < 0;
      if (weight > 0) add(set.joints[vertex][k], double(weight));
    }
  }
  tally.negative += negative ? 1 : 0;
  if (!(total > 0)) {
    ++tally.unbound;
    add(sets.front().joints[vertex].x, 1);
  } else if (std::abs(total - 1) > 0.02) {  // eight weights of 8 bits may be off by half a step each
    ++tally.scaled;
  }
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) sum[i][k] /= total;
  sum[3][3] = 1;
  return sum;
}

V3f unit(const V3d& v) {
  const double length = v.length();
  return length > 0 ? V3f(v / length) : V3f(0, 0, 0);
}

}  // namespace

Skin make_skin(const Document& document, std::size_t index, const std::vector<M44d>& to_world) {
  const json& source = element(document, "skins", index);
  Skin skin;
  skin.what = label("skins", index, source.value("name", std::string()));
  const json& joints = source["joints"];
  std::vector<M44d> inverse_bind(joints.size());
  const auto matrices = source.find("inverseBindMatrices");
  if (matrices != source.end()) {
    const std::string what = skin.what + " inverseBindMatrices";
    const int accessor = matrices->get<int>();
    if (document.model.accessors[std::size_t(accessor)].componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
      document.fail(what + " are not floats", remedy);
    const std::vector<float> floats = read_floats(document, accessor, 16, what);
    if (floats.size() < 16 * joints.size())
      document.fail(fmt::format("{} are {} for {} joints", what, floats.size() / 16, joints.size()), remedy);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      for (int i = 0; i < 16; ++i) inverse_bind[j][i / 4][i % 4] = double(floats[16 * j + std::size_t(i)]);
      const M44d& m = inverse_bind[j];
      if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1)
        document.fail(fmt::format("{} has matrix {}, which is not affine", what, j), remedy);
    }
  }
  const M44d& first = to_world[joints[0].get<std::size_t>()];
  skin.origin = row(first, 3);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    M44d joint = to_world[joints[j].get<std::size_t>()];
    for (int k = 0; k < 3; ++k) joint[3][k] -= skin.origin[k];
    skin.from_mesh.push_back(inverse_bind[j] * joint);
    skin.has_inverse.push_back(is_singular(inverse_bind[j]) ? 0 : 1);
  }
  return skin;
}

bool is_skinned(const Attributes& attributes) { return attributes.has("JOINTS_0"); }

// glTF 2.0, 3.7.3.3: p' = sum of w_j p B_j J_j over the joints, B the inverse bind matrix and J the joint's transform
// to the world. Normals go by the cofactors of the linear part, which turn cross products as it turns vectors: they
// keep to the side that the posed triangles' corners give, mirrored or not.
void apply_skin(Document& document, const Attributes& attributes, const Skin& skin, Mesh& mesh) {
  std::vector<Influences> sets;
  for (int set = 0; attributes.has(fmt::format("JOINTS_{}", set)); ++set)
    sets.push_back(read_influences(document, attributes, set));
  Tally tally;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const M44d m = blend(document, attributes, skin, sets, v, tally);
    mesh.positions[v] = V3f(V3d(mesh.positions[v]) * m);
    const std::array<V3d, 3> rows{row(m, 0), row(m, 1), row(m, 2)};
    if (!mesh.normals.empty()) {
      const V3f n = mesh.normals[v];
      mesh.normals[v] = unit(rows[1].cross(rows[2]) * double(n.x) + rows[2].cross(rows[0]) * double(n.y) +
                             rows[0].cross(rows[1]) * double(n.z));
    }
    if (!mesh.tangents.empty()) {
      const V4f t = mesh.tangents[v];
      const V3f turned = unit(rows[0] * double(t.x) + rows[1] * double(t.y) + rows[2] * double(t.z));
      mesh.tangents[v] = V4f(turned.x, turned.y, turned.z, t.w);
    }
  }
  if (tally.negative > 0) {
    document.warn(
        fmt::format("{} has {} vertices with skin weights below 0, which count as 0", attributes.what, tally.negative));
  }
  if (tally.scaled > 0) {
    document.warn(fmt::format("{} has {} vertices whose skin weights do not sum to 1; they are scaled to it",
                              attributes.what, tally.scaled));
  }
  if (tally.unbound > 0) {
    document.warn(fmt::format("{} has {} vertices without skin weights, which follow their first joint",
                              attributes.what, tally.unbound));
  }
}

}  // namespace ivory::gltf
