#include "grid/io/lobes.h"

#include "grid/base/error.h"
#include "grid/io/exr.h"

namespace ivory {

namespace {

constexpr const char* remedy = "make one with: ivory bake lobes -o LOBES.exr";
const std::vector<std::string> channel_names{"integral", "axis", "exponent"};

}  // namespace

void write_lobes(const std::string& path, const LobeTable& table, const Metadata& metadata, bool force) {
  ExrAsset asset;
  asset.kind = lobes_kind;
  asset.width = table.angle_nodes;
  asset.height = table.exponent_nodes * table.exponent_nodes;
  asset.channels = channel_names;
  asset.values = table.values;
  asset.metadata = metadata;
  asset.metadata["format_version"] = std::int64_t(1);
  asset.metadata["exponent_nodes"] = std::int64_t(table.exponent_nodes);
  asset.metadata["angle_nodes"] = std::int64_t(table.angle_nodes);
  asset.metadata["largest_exponent"] = double(max_lobe_exponent);
  write_exr(path, asset, ExrPrecision::float32, force);
}

LobesFile read_lobes(const std::string& path) {
  ExrAsset asset = read_exr(path, lobes_kind, remedy);
  LobesFile file;
  const std::int64_t nodes = find_int(asset.metadata, "exponent_nodes").value_or(0);
  const std::int64_t angles = find_int(asset.metadata, "angle_nodes").value_or(0);
  if (find_int(asset.metadata, "format_version") != 1) throw Error(path, "is of another format version", remedy);
  if (asset.channels != channel_names || nodes < 2 || nodes > 129 || angles < 2 || angles != asset.width ||
      nodes * nodes != asset.height)
    throw Error(path, "is damaged (its size is not that of a lobe table)", remedy);
  file.table.exponent_nodes = int(nodes);
  file.table.angle_nodes = int(angles);
  file.table.values = std::move(asset.values);
  // Bounds that any table keeps: a product is no negative light, and a lobe no wider than its factors.
  for (std::size_t i = 0; i < file.table.values.size(); i += LobeTable::channels) {
    const float* v = file.table.values.data() + i;
    if (!(v[0] >= 0 && v[0] < 10 && v[1] > -10 && v[1] < 10 && v[2] > 0.9F && v[2] < 10))
      throw Error(path, "holds values that no lobe table has", remedy);
  }
  file.metadata = std::move(asset.metadata);
  return file;
}

}  // namespace ivory
