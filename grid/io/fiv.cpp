#include "grid/io/fiv.h"

#include <algorithm>
#include <cmath>

#include "grid/base/error.h"

namespace ivory {

namespace {

const std::string remedy = "bake it with ivory bake fiv";
// 2: the shape has reaches too. 3: a set of turns.
constexpr std::int64_t format_version = 2;
constexpr std::int64_t set_format_version = 3;
constexpr int most_turns = 360;

std::vector<std::string> channel_names(int hemispheres) {
  const std::string axes = "xyz";
  std::vector<std::string> vectors;
  for (const char axis : axes) vectors.push_back(std::string("F") + axis);
  if (hemispheres == 6) {
    for (const char split : axes) {
      for (const char axis : axes) vectors.push_back(std::string("D") + split + axis);
    }
  }
  std::vector<std::string> names;
  for (const std::string& vector : vectors) {
    for (const char* color : {".R", ".G", ".B"}) names.push_back(vector + color);
  }
  return names;
}

const std::vector<float>& list(const std::string& path, const ExrAsset& asset, const char* key, std::size_t size) {
  const auto found = asset.lists.find(key);
  if (found == asset.lists.end() || (size != 0 && found->second.size() != size) ||
      !std::all_of(found->second.begin(), found->second.end(), [](float x) { return std::isfinite(x); }))
    throw Error(path, std::string("is damaged (attribute ") + key + ")", remedy);
  return found->second;
}

}  // namespace

void write_fiv(const std::string& path, const FivTable& table, ExrPrecision precision, bool force) {
  write_fiv(path, FivSet{{table}}, precision, force);
}

void write_fiv(const std::string& path, const FivSet& set, ExrPrecision precision, bool force) {
  const FivTable& table = set.turns.front();
  const std::size_t turns = set.turns.size();
  ExrAsset asset;
  asset.kind = "fiv";
  asset.width = table.size.x;
  asset.height = table.size.y * table.size.z * int(turns);
  asset.channels = channel_names(table.hemispheres);
  std::vector<float> coverage;
  for (const FivTable& turn : set.turns) {
    asset.values.insert(asset.values.end(), turn.values.begin(), turn.values.end());
    coverage.push_back(turn.coverage);
  }
  asset.metadata = table.metadata;
  asset.metadata["format_version"] = turns == 1 ? format_version : set_format_version;
  if (turns > 1) asset.metadata["turns"] = std::int64_t(turns);
  asset.metadata["azimuths"] = std::int64_t(table.size.x);
  asset.metadata["polar_angles"] = std::int64_t(table.size.y);
  asset.metadata["spheres"] = std::int64_t(table.size.z);
  asset.metadata["hemispheres"] = std::int64_t(table.hemispheres);
  asset.metadata["precision"] = std::string(name_of(precision));
  asset.lists["radii"] = table.radii;
  asset.lists["sphere_m"] = {table.center_m.x, table.center_m.y, table.center_m.z, table.radius_m};
  asset.lists["coverage"] = coverage;
  asset.lists["total"] = {table.total.begin(), table.total.end()};
  asset.lists["shape"] = {table.shape.begin(), table.shape.end()};
  write_exr(path, asset, precision, force);
}

FivTable read_fiv(const std::string& path) { return std::move(read_fiv_set(path).turns.front()); }

FivSet read_fiv_set(const std::string& path) {
  ExrAsset asset = read_exr(path, "fiv", remedy);
  const auto integer = [&](const char* key) {
    const auto value = find_int(asset.metadata, key);
    if (!value || *value < 1 || *value > 1 << 20)
      throw Error(path, std::string("is damaged (attribute ") + key + ")", remedy);
    return int(*value);
  };
  const int version = integer("format_version");
  if (version != format_version && version != set_format_version) {
    throw Error(path,
                "is an FIV table of format version " + std::to_string(version) + ", this ivory reads versions " +
                    std::to_string(format_version) + " and " + std::to_string(set_format_version),
                "bake it again with ivory bake fiv");
  }
  const int turns = version == set_format_version ? integer("turns") : 1;
  if (turns > most_turns) throw Error(path, "is damaged (attribute turns)", remedy);
  FivTable table;
  table.size = {integer("azimuths"), integer("polar_angles"), integer("spheres")};
  table.hemispheres = integer("hemispheres");
  if ((table.hemispheres != 1 && table.hemispheres != 6) || table.size.x < 3 || table.size.y < 2 || table.size.z < 2 ||
      asset.width != table.size.x || std::int64_t(asset.height) != std::int64_t(table.size.y) * table.size.z * turns ||
      asset.channels != channel_names(table.hemispheres))
    throw Error(path, "is damaged (its sizes do not fit together)", remedy);
  table.radii = list(path, asset, "radii", std::size_t(table.size.z));
  const std::vector<float>& sphere = list(path, asset, "sphere_m", 4);
  table.center_m = {sphere[0], sphere[1], sphere[2]};
  table.radius_m = sphere[3];
  const std::vector<float>& coverage = list(path, asset, "coverage", std::size_t(turns));
  const std::vector<float>& total = list(path, asset, "total", table.total.size());
  std::copy(total.begin(), total.end(), table.total.begin());
  const std::vector<float>& shape = list(path, asset, "shape", table.shape.size());
  std::copy(shape.begin(), shape.end(), table.shape.begin());
  bool ascending = table.radii.front() > 0;
  for (std::size_t k = 1; k < table.radii.size(); ++k) ascending = ascending && table.radii[k - 1] < table.radii[k];
  if (!ascending || !(table.radius_m > 0)) throw Error(path, "is damaged (its spheres do not ascend)", remedy);
  table.metadata = std::move(asset.metadata);
  FivSet set;
  if (turns == 1) {
    table.coverage = coverage.front();
    table.values = std::move(asset.values);
    set.turns.push_back(std::move(table));
    return set;
  }
  const std::size_t one = asset.values.size() / std::size_t(turns);
  for (int k = 0; k < turns; ++k) {
    set.turns.push_back(table);
    set.turns.back().coverage = coverage[std::size_t(k)];
    const auto begin = asset.values.begin() + std::ptrdiff_t(std::size_t(k) * one);
    set.turns.back().values.assign(begin, begin + std::ptrdiff_t(one));
  }
  return set;
}

}  // namespace ivory
