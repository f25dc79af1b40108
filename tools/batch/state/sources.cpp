#include "tools/batch/state/sources.h"

#include <filesystem>

#include <fmt/format.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/io/file.h"
#include "tracer/gltf/loader.h"

namespace ivory {

namespace {

std::string key_of(const std::string& path, const LoadParams& params) {
  std::string key = path;
  if (params.scale != 1) key += fmt::format(" --scale {}", params.scale);
  if (params.time_s) key += fmt::format(" --time {}", *params.time_s);
  if (!params.animation.empty()) key += " --animation " + params.animation;
  for (const std::string& node : params.without) key += " --without " + node;
  for (const int set : params.uv_sets) key += fmt::format(" TEXCOORD_{}", set);
  return key;
}

// Of all nodes that have triangles below them, and a name or a table, in the file's order.
std::vector<NodeBox> node_boxes(const Scene& scene) {
  std::vector<Imath::Box3d> boxes(scene.nodes.size());
  for (const Instance& instance : scene.instances) {
    Imath::Box3d box;
    for (const V3f& p : scene.meshes[std::size_t(instance.mesh)].positions)
      box.extendBy(to_world(p * instance.to_world, scene.anchor_m));
    for (int node = instance.node; node != no_index; node = scene.nodes[std::size_t(node)].parent)
      boxes[std::size_t(node)].extendBy(box);
  }
  std::vector<NodeBox> nodes;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].isEmpty() && !(scene.nodes[i].name.empty() && scene.nodes[i].fiv_table.empty()))
      nodes.push_back({scene.nodes[i].name, boxes[i], scene.nodes[i].fiv_table});
  }
  return nodes;
}

}  // namespace

const std::string& Sources::hash(const std::string& path) {
  const auto found = hashes_.find(path);
  if (found != hashes_.end()) return found->second;
  return hashes_[path] = file_hash(path);
}

void Sources::forget(const std::string& path) { hashes_.erase(path); }

bool Sources::is_unchanged(const SceneFacts& facts) {
  for (const auto& [file, known] : facts.files) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error) || hash(file) != known) return false;
  }
  return true;
}

const SceneFacts& Sources::scene(const std::string& path, const LoadParams& params) {
  const std::string key = key_of(path, params);
  if (const auto found = facts_.find(key); found != facts_.end()) return found->second;
  const auto known = known_.find(key);
  if (known != known_.end() && is_unchanged(known->second)) return facts_[key] = known->second;
  const LoadedScene loaded = load_gltf(path, params);
  SceneFacts facts;
  for (const std::string& file : loaded.files) facts.files.emplace_back(file, hash(file));
  facts.parts = content_parts(loaded.scene);
  facts.nodes = node_boxes(loaded.scene);
  return facts_[key] = std::move(facts);
}

}  // namespace ivory
