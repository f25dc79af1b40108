#include "tracer/gltf/nodes/tree.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "tracer/core/scene.h"

namespace ivory::gltf {

using Imath::M44d;
using nlohmann::json;

std::string node_label(const Document& document, std::size_t node) {
  return label("nodes", node, document.model.nodes[node].name);
}

M44d trs_matrix(const V3d& translation, Imath::Quatd rotation, const V3d& scale) {
  rotation.normalize();
  M44d matrix = rotation.toMatrix44();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) matrix[row][column] *= scale[row];
  for (int column = 0; column < 3; ++column) matrix[3][column] = translation[column];
  return matrix;
}

// Rounding by exporters and 8-bit storage stay within a percent; anything else was not a rotation.
Imath::Quatd checked_rotation(const Document& document, const std::string& what, double x, double y, double z,
                              double w) {
  const double length = std::sqrt(x * x + y * y + z * z + w * w);
  if (!(std::abs(length - 1) < 0.01))
    document.fail(fmt::format("{} has a rotation quaternion of length {}", what, length), remedy);
  return {w, x, y, z};
}

M44d local_matrix(const Document& document, std::size_t index) {
  const tinygltf::Node& node = document.model.nodes[index];
  // tinygltf drops the three where there is a matrix.
  const json& source = element(document, "nodes", index);
  const bool has_trs = source.contains("translation") || source.contains("rotation") || source.contains("scale");
  M44d matrix;
  if (!node.matrix.empty()) {
    if (has_trs)
      document.fail(node_label(document, index) + " has both a matrix and translation, rotation or scale", remedy);
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = node.matrix[std::size_t(i)];
    if (matrix[0][3] != 0 || matrix[1][3] != 0 || matrix[2][3] != 0 || matrix[3][3] != 1)
      document.fail(node_label(document, index) + " has a matrix that is not affine", remedy);
    return matrix;
  }
  const V3d translation =
      node.translation.empty() ? V3d(0) : V3d(node.translation[0], node.translation[1], node.translation[2]);
  const V3d scale = node.scale.empty() ? V3d(1) : V3d(node.scale[0], node.scale[1], node.scale[2]);
  const Imath::Quatd rotation = node.rotation.empty()
                                    ? Imath::Quatd()
                                    : checked_rotation(document, node_label(document, index), node.rotation[0],
                                                       node.rotation[1], node.rotation[2], node.rotation[3]);
  return trs_matrix(translation, rotation, scale);
}

// Every node has at most one parent, and every node is reached from a root: then there is no cycle.
std::vector<int> find_parents(const Document& document) {
  const auto& nodes = document.model.nodes;
  std::vector<int> parents(nodes.size(), no_index);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const int child : nodes[i].children) {
      int& parent = parents[std::size_t(child)];
      if (parent != no_index) {
        document.fail(fmt::format("{} is a child of nodes[{}] and of nodes[{}]",
                                  node_label(document, std::size_t(child)), parent, i),
                      remedy);
      }
      parent = int(i);
    }
  }
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (parents[i] == no_index) open.push_back(i);
  std::vector<char> reached(nodes.size(), 0);
  while (!open.empty()) {
    const std::size_t node = open.back();
    open.pop_back();
    reached[node] = 1;
    for (const int child : nodes[node].children) open.push_back(std::size_t(child));
  }
  const auto lost = std::find(reached.begin(), reached.end(), 0);
  if (lost != reached.end())
    document.fail(node_label(document, std::size_t(lost - reached.begin())) + " is part of a loop", remedy);
  return parents;
}

std::vector<M44d> world_matrices(const Document& document) {
  const std::vector<int> parents = find_parents(document);
  std::vector<M44d> matrices(parents.size());
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < parents.size(); ++i)
    if (parents[i] == no_index) open.push_back(i);
  while (!open.empty()) {
    const std::size_t node = open.back();
    open.pop_back();
    matrices[node] = local_matrix(document, node);
    if (parents[node] != no_index) matrices[node] = matrices[node] * matrices[std::size_t(parents[node])];
    for (const int child : document.model.nodes[node].children) open.push_back(std::size_t(child));
  }
  return matrices;
}

std::vector<char> find_nodes(const Document& document, const std::vector<std::string>& names) {
  const std::vector<tinygltf::Node>& nodes = document.model.nodes;
  std::vector<char> found(nodes.size(), 0);
  for (const std::string& name : names) {
    bool any = false;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (name.empty() || nodes[i].name != name) continue;
      found[i] = 1;
      any = true;
    }
    if (any) continue;
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), index);
    if (error != std::errc() || end != name.data() + name.size() || index >= nodes.size()) {
      throw ParameterError(
          "without", fmt::format("{} has no node '{}'; it has {}, counted from 0", document.path, name, nodes.size()));
    }
    found[index] = 1;
  }
  return found;
}

std::vector<int> root_nodes(Document& document, const std::vector<int>& parents) {
  const tinygltf::Model& model = document.model;
  for (std::size_t s = 0; s < model.scenes.size(); ++s) {
    std::vector<int> sorted = model.scenes[s].nodes;
    for (const int node : sorted) {
      if (parents[std::size_t(node)] != no_index) {
        document.fail(fmt::format("scenes[{}] lists {}, which is a child of another node", s,
                                  node_label(document, std::size_t(node))),
                      remedy);
      }
    }
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
      document.fail(fmt::format("scenes[{}] lists a node twice", s), remedy);
  }
  if (!model.scenes.empty()) return model.scenes[std::size_t(std::max(model.defaultScene, 0))].nodes;
  std::vector<int> roots;
  for (std::size_t i = 0; i < parents.size(); ++i)
    if (parents[i] == no_index) roots.push_back(int(i));
  if (!roots.empty()) document.warn("has no scene; all its nodes are taken");
  return roots;
}

}  // namespace ivory::gltf
