#include "tools/batch/work/predict.h"

#include <algorithm>
#include <cmath>

#include "tools/cli/box.h"
#include "tools/cli/numbers.h"

namespace ivory {

namespace {

const JobOption* find_given(const JobAsset& asset, const std::string& name) {
  for (const JobOption& option : asset.options) {
    if (option.name == name) return &option;
  }
  return nullptr;
}

double number(const JobAsset& asset, const std::string& name, double otherwise) {
  const JobOption* option = find_given(asset, name);
  if (option == nullptr || option->values.empty()) return otherwise;
  return parse_number(option->values.front()).value_or(otherwise);
}

double cells(const JobOption& option, int least) {
  const V3i size = parse_size3("--" + option.name, option.values.front(), least);
  return double(size.x) * double(size.y) * double(size.z);
}

// Vertices of a grid whose spacing is given; 0 where the bake chooses it, or the scene decides.
double vertices_of(const JobAsset& asset) {
  if (const JobOption* resolution = find_given(asset, "resolution")) return cells(*resolution, 2);
  const double voxel_m = number(asset, "voxel-size", 0);
  const JobOption* bounds = find_given(asset, "bounds");
  if (!(voxel_m > 0) || bounds == nullptr) return 0;
  const Imath::Box3d box = parse_bounds("--bounds", bounds->values.front());
  const V3d size = box.size();
  return (size.x / voxel_m + 2) * (size.y / voxel_m + 2) * (size.z / voxel_m + 2);
}

double memory_of(const JobAsset& asset, int threads, double limit_bytes) {
  const std::string& kind = asset.kind->name;
  if (kind == "grid") {
    if (const JobOption* most = find_given(asset, "max-memory"))
      return double(parse_count("--max-memory", most->values.front()));
    const double vertices = vertices_of(asset);
    // Eight octants of three channels: floats a thread, 64-bit sums once, and what is known of each vertex.
    return vertices > 0 ? vertices * (96.0 * threads + 400) : limit_bytes / 2;
  }
  if (kind == "fiv") {
    // As tools/bake/fiv.cpp counts them, of six hemispheres.
    const JobOption* samples = find_given(asset, "samples");
    const double count = samples != nullptr ? cells(*samples, 2) : 192.0 * 97 * 68;
    return count * (3 * 12 * 4 * 11 + 9 * 50);
  }
  if (kind == "cubemap") {
    const double capture = number(asset, "capture", 256);
    return 6 * capture * capture * 64 + 64e6;
  }
  if (kind == "render") {
    double pixels = 640.0 * 480;
    if (const JobOption* size = find_given(asset, "size")) {
      const Imath::V2i given = parse_image_size("--size", size->values.front());
      pixels = double(given.x) * double(given.y);
    }
    return pixels * 64 + 128e6;
  }
  return 256e6;
}

}  // namespace

AssetCost cost_of(const JobAsset& asset, const AssetRecord* record, int threads, double limit_bytes) {
  AssetCost cost;
  cost.memory_bytes = memory_of(asset, threads, limit_bytes);
  cost.seconds = asset.kind->heft;
  if (record == nullptr || !record->finished) return cost;
  cost.seconds = record->seconds;
  cost.measured = true;
  if (record->memory_bytes > 0) cost.memory_bytes = std::min(cost.memory_bytes, record->memory_bytes);
  return cost;
}

}  // namespace ivory
