#include "tools/batch/state/record.h"

#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/io/file.h"

namespace ivory {

namespace {

using Json = nlohmann::ordered_json;

constexpr int record_version = 1;

Json pairs_json(const std::vector<std::pair<std::string, std::string>>& pairs) {
  Json json = Json::array();
  for (const auto& [name, value] : pairs) json.push_back({name, value});
  return json;
}

std::vector<std::pair<std::string, std::string>> pairs_of(const Json& json) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const Json& pair : json) pairs.emplace_back(pair.at(0).get<std::string>(), pair.at(1).get<std::string>());
  return pairs;
}

Json parts_json(const std::vector<ContentPart>& parts) {
  Json json = Json::array();
  for (const ContentPart& part : parts)
    json.push_back({name_of(part.kind), part.name, fmt::format("{:016x}", part.hash)});
  return json;
}

std::vector<ContentPart> parts_of(const Json& json) {
  std::vector<ContentPart> parts;
  for (const Json& part : json) {
    parts.push_back({from_name<ContentKind>(part.at(0).get<std::string>()), part.at(1).get<std::string>(),
                     std::stoull(part.at(2).get<std::string>(), nullptr, 16)});
  }
  return parts;
}

Json point_json(const V3d& p) { return {p.x, p.y, p.z}; }
V3d point_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

// Assets of one scene share what they depend on: each list stands in the file once.
class PartLists {
 public:
  std::size_t add(const std::vector<ContentPart>& parts) {
    Json json = parts_json(parts);
    const auto [found, fresh] = known_.emplace(json.dump(), lists_.size());
    if (fresh) lists_.push_back(std::move(json));
    return found->second;
  }
  Json take() { return std::move(lists_); }

 private:
  std::map<std::string, std::size_t> known_;
  Json lists_ = Json::array();
};

Json to_json(const BatchRecord& record) {
  PartLists lists;
  Json scenes = Json::object();
  for (const auto& [key, facts] : record.scenes) {
    Json nodes = Json::array();
    for (const NodeBox& node : facts.nodes)
      nodes.push_back({node.name, point_json(node.bounds_m.min), point_json(node.bounds_m.max), node.fiv_table});
    scenes[key] = {{"files", pairs_json(facts.files)}, {"parts", lists.add(facts.parts)}, {"nodes", std::move(nodes)}};
  }
  Json assets = Json::object();
  for (const auto& [name, asset] : record.assets) {
    Json parts = Json::object();
    for (const auto& [scene, list] : asset.inputs.parts) parts[scene] = lists.add(list);
    assets[name] = {{"inputs", pairs_json(asset.inputs.entries)}, {"parts", std::move(parts)},
                    {"outputs", pairs_json(asset.outputs)},       {"seconds", asset.seconds},
                    {"memory_bytes", asset.memory_bytes},         {"finished", asset.finished}};
  }
  return {{"ivory_batch", record_version},
          {"scenes", std::move(scenes)},
          {"assets", std::move(assets)},
          {"parts", lists.take()}};
}

BatchRecord from_json(const Json& json) {
  const Json& lists = json.at("parts");
  BatchRecord record;
  for (const auto& [key, scene] : json.at("scenes").items()) {
    SceneFacts& facts = record.scenes[key];
    facts.files = pairs_of(scene.at("files"));
    facts.parts = parts_of(lists.at(scene.at("parts").get<std::size_t>()));
    for (const Json& node : scene.at("nodes"))
      facts.nodes.push_back(
          {node.at(0).get<std::string>(), {point_of(node.at(1)), point_of(node.at(2))}, node.at(3).get<std::string>()});
  }
  for (const auto& [name, stored] : json.at("assets").items()) {
    AssetRecord& asset = record.assets[name];
    asset.inputs.entries = pairs_of(stored.at("inputs"));
    for (const auto& [scene, list] : stored.at("parts").items())
      asset.inputs.parts[scene] = parts_of(lists.at(list.get<std::size_t>()));
    asset.outputs = pairs_of(stored.at("outputs"));
    asset.seconds = stored.at("seconds").get<double>();
    asset.memory_bytes = stored.at("memory_bytes").get<double>();
    asset.finished = stored.at("finished").get<bool>();
  }
  return record;
}

}  // namespace

BatchRecord read_record(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return {};
  const std::string remedy = "remove it: all is baked again, with --force over what is there";
  std::ifstream file(path, std::ios::binary);
  try {
    const Json json = Json::parse(file);
    if (json.at("ivory_batch") != record_version)
      throw Error(path, "is a batch's record of another version of ivory", remedy);
    return from_json(json);
  } catch (const Error&) {
    throw;
  } catch (const std::exception&) {
    throw Error(path, "is no record of a batch, or damaged", remedy);
  }
}

void write_record(const std::string& path, const BatchRecord& record) {
  write_file(path, to_json(record).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n", /*force=*/true);
}

}  // namespace ivory
