#include "grid/io/difmap.h"

#include "grid/base/error.h"
#include "grid/io/exr.h"

namespace ivory {

namespace {

constexpr const char* kind = "difmap";
constexpr const char* remedy = "bake it with 'ivory bake difmap'";
constexpr std::int64_t format_version = 1;

}  // namespace

void write_difmap(const std::string& path, const DifMap& map, bool force) {
  ExrAsset asset;
  asset.kind = kind;
  asset.width = map.e.size;
  asset.height = cube_faces * map.e.size;
  asset.channels = {"R", "G", "B"};
  asset.values.reserve(3 * map.e.texels.size());
  for (const Rgb& e : map.e.texels) asset.values.insert(asset.values.end(), {e.x, e.y, e.z});
  asset.metadata = map.metadata;
  asset.metadata["format_version"] = format_version;
  asset.metadata["ivory_version"] = std::string(IVORY_VERSION);
  asset.metadata["units"] = std::string("lux");
  asset.cube_environment = true;
  write_exr(path, asset, ExrPrecision::float32, force);
}

DifMap read_difmap(const std::string& path) {
  ExrAsset asset = read_exr(path, kind, remedy);
  if (find_int(asset.metadata, "format_version") != format_version)
    throw Error(path, "has another format version than this ivory reads", remedy);
  if (asset.width < 1 || asset.height != cube_faces * asset.width ||
      asset.channels != std::vector<std::string>{"R", "G", "B"}) {
    throw Error(path, "has not the shape of six faces in R, G and B", remedy);
  }
  DifMap map;
  map.e.size = asset.width;
  map.e.texels.reserve(asset.values.size() / 3);
  for (std::size_t i = 0; i < asset.values.size(); i += 3) {
    map.e.texels.emplace_back(asset.values[i], asset.values[i + 1], asset.values[i + 2]);
    const Rgb& e = map.e.texels.back();
    if (e.x < 0 || e.y < 0 || e.z < 0) throw Error(path, "holds negative irradiance", remedy);
  }
  map.metadata = std::move(asset.metadata);
  return map;
}

bool is_difmap(const std::string& path) { return exr_asset_kind(path) == kind; }

}  // namespace ivory
