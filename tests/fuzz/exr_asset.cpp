// Baked .exr assets behind their checksum: valid ones with attributes, sizes and values replaced, written with the
// checksum that this gives.
#include <cmath>
#include <filesystem>

#include "grid/cubemap/reader.h"
#include "grid/io/exr.h"
#include "tests/fuzz/samples.h"
#include "tests/fuzz/support.h"

namespace {

using namespace ivory;

struct Samples {
  std::vector<ExrAsset> assets;
  Samples() {
    const std::string folder = std::filesystem::path(fuzz::file_of(nullptr, 0, ".exr")).parent_path().string();
    fuzz::write_exr_samples(folder);
    for (const std::string name : fuzz::exr_samples) {
      const std::string path = folder + "/" + name + ".exr";
      assets.push_back(read_exr(path, exr_asset_kind(path), ""));
    }
  }
};

template <typename Map>
auto& entry(fuzz::Bytes& bytes, Map& map) {
  auto at = map.begin();
  std::advance(at, std::ptrdiff_t(bytes.below_or(map.size() - 1)));
  return *at;
}

void change(fuzz::Bytes& bytes, ExrAsset& asset) {
  switch (bytes.byte() % 8) {
    case 0:
      entry(bytes, asset.metadata).second = bytes.integer();
      break;
    case 1:
      entry(bytes, asset.metadata).second = bytes.wide_number();
      break;
    case 2:
      entry(bytes, asset.metadata).second = bytes.text(12);
      break;
    case 3:
      asset.metadata.erase(entry(bytes, asset.metadata).first);
      if (asset.metadata.empty()) asset.metadata["x"] = std::int64_t(1);
      break;
    case 4: {
      if (asset.lists.empty()) break;
      std::vector<float>& list = entry(bytes, asset.lists).second;
      list.resize(bytes.below_or(40));
      for (float& value : list) value = bytes.number();
      break;
    }
    case 5:
      if (!asset.lists.empty()) asset.lists.erase(asset.lists.begin());
      break;
    case 6:
      // Of few pixels, so that the rest comes round often.
      asset.width = int(1 + bytes.below_or(9));
      asset.height = int(1 + bytes.below_or(59));
      asset.values.resize(std::size_t(asset.width) * std::size_t(asset.height) * asset.channels.size());
      break;
    default:
      for (std::size_t i = bytes.byte() % 16; i-- > 0 && !asset.values.empty();) {
        const float value = bytes.number();
        if (std::isfinite(value)) asset.values[bytes.below_or(asset.values.size() - 1)] = value;
      }
  }
}

void check_cube(const LocalizedCube& cube, fuzz::Bytes& bytes) {
  V3f p;
  for (int i = 0; i < 3; ++i) p[i] = bytes.number();
  for (const CubeMethod method : values_of<CubeMethod>()) {
    const CubeReader reader = make_cube_reader(cube, method);
    for (const Rgb& e : {irradiance(reader, p, V3f(0, 1, 0)), irradiance(cube, method, p, V3f(0, 0, -1))})
      for (int c = 0; c < 3; ++c)
        fuzz::require(e[c] >= 0 && std::isfinite(e[c]), "E of a cube map that is negative or not finite");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Samples samples;
  fuzz::Bytes bytes(data, size);
  ExrAsset asset = samples.assets[bytes.below_or(samples.assets.size() - 1)];
  for (int i = 0; i < 8 && !bytes.empty(); ++i) change(bytes, asset);
  const std::string path = fuzz::file_of(nullptr, 0, ".exr");
  const bool written = fuzz::reads(path, [&] { write_exr(path, asset, ExrPrecision::float32, /*force=*/true); });
  if (!written) return 0;
  fuzz::reads(path, [&] {
    if (asset.kind == "difmap") {
      fuzz::require(irradiance(read_difmap(path), V3f(0, 1, 0)).x >= 0, "negative E of a DifMap");
    } else if (asset.kind == "cubemap") {
      check_cube(read_localized_cube(path), bytes);
    } else if (asset.kind == "lobes") {
      const LobesFile file = read_lobes(path);
      lobe_product(file.table, {V3f(0, 1, 0), 1, std::abs(bytes.number())}, {V3f(0, 0, 1), 1, 5});
    } else {
      const FivTable table = read_fiv(path);
      fuzz::require(fuzz::all_finite(table.values) && fuzz::all_finite(table.radii), "an FIV table's numbers");
      V3f q;
      for (int i = 0; i < 3; ++i) q[i] = bytes.number();
      lookup(table, q);
    }
  });
  return 0;
}
