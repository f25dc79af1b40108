// Localized cube maps as files: what is read is what was written, or one line says why not.
#include "grid/io/cubemap.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/cubemap/captured.h"
#include "grid/io/exr.h"
#include "tests/support/paths.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

std::string path_of(const std::string& name) {
  fs::create_directories(output_folder);
  return std::string(output_folder) + "/localized_" + name;
}

LocalizedCube any_cube(int size) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0, 1);
  CapturedCube captured;
  captured.origin_m = V3f(0.1F, -2.5F, 1e3F);
  captured.radiance.size = size;
  for (int i = 0; i < 6 * size * size; ++i) {
    captured.radiance.texels.emplace_back(unit(random), 1e6F * unit(random), 0.0F);
    captured.inverse_distance.push_back(i % 5 == 0 ? 0.0F : unit(random));
  }
  LocalizedCube cube = localize(captured, size, ShellFit::corners);
  cube.metadata["seed"] = std::int64_t(7);
  cube.metadata["scene"] = std::string("room.glb");
  return cube;
}

TEST(LocalizedCubeFile, ReadsWhatWasWritten) {
  for (const int size : {1, 2, 5, 8}) {
    const LocalizedCube cube = any_cube(size);
    const std::string path = path_of("round_trip.exr");
    write_localized_cube(path, cube, /*force=*/true);
    EXPECT_EQ(exr_asset_kind(path), "cubemap");
    const LocalizedCube read = read_localized_cube(path);
    EXPECT_EQ(read.origin_m, cube.origin_m);
    EXPECT_EQ(read.radiance.size, size);
    EXPECT_EQ(read.radiance.texels, cube.radiance.texels);
    EXPECT_EQ(read.metadata.at("seed"), MetaValue(std::int64_t(7)));
    EXPECT_EQ(read.metadata.at("scene"), MetaValue(std::string("room.glb")));
    ASSERT_EQ(read.corners.size(), cube.corners.size());
    for (std::size_t i = 0; i < cube.corners.size(); ++i) {
      for (std::size_t k = 0; k < 4; ++k)  // to distance and back: two roundings
        EXPECT_NEAR(read.corners[i][k], cube.corners[i][k], 2e-7F * cube.corners[i][k]);
    }
  }
}

// Distances are stored along the direction to the corner, not along the face's axis.
TEST(LocalizedCubeFile, StoresInverseDistances) {
  LocalizedCube cube;
  cube.radiance.size = 1;
  cube.radiance.texels.assign(6, Rgb(1, 1, 1));
  cube.corners.assign(6, TexelCorners{0.5F, 0.5F, 0.5F, 0.5F});  // a cube of half side 2
  const std::string path = path_of("distances.exr");
  write_localized_cube(path, cube, true);
  const ExrAsset asset = read_exr(path, "cubemap", "");
  ASSERT_EQ(asset.values.size(), 42U);
  for (std::size_t i = 3; i < 7; ++i) EXPECT_FLOAT_EQ(asset.values[i], float(1 / (2 * std::sqrt(3.0))));
}

TEST(LocalizedCubeFile, RefusesOthers) {
  const std::string path = path_of("bad.exr");
  const auto write_changed = [&](const std::function<void(ExrAsset&)>& change) {
    write_localized_cube(path, any_cube(2), true);
    ExrAsset asset = read_exr(path, "cubemap", "");
    change(asset);
    write_exr(path, asset, ExrPrecision::float32, true);
  };
  write_changed([](ExrAsset&) {});
  EXPECT_NO_THROW(read_localized_cube(path));
  write_changed([](ExrAsset& a) { a.kind = "difmap"; });
  EXPECT_THROW(read_localized_cube(path), Error);
  write_changed([](ExrAsset& a) { a.metadata["format_version"] = std::int64_t(2); });
  EXPECT_THROW(read_localized_cube(path), Error);
  write_changed([](ExrAsset& a) { a.lists.clear(); });
  EXPECT_THROW(read_localized_cube(path), Error);
  write_changed([](ExrAsset& a) {
    a.height = 11;
    a.values.resize(2 * 11 * 7);
  });
  EXPECT_THROW(read_localized_cube(path), Error);
  write_changed([](ExrAsset& a) { a.values[3] += 1; });  // a corner that its neighbours have elsewhere
  EXPECT_THROW(read_localized_cube(path), Error);
  write_changed([](ExrAsset& a) { a.values[0] = -1; });
  EXPECT_THROW(read_localized_cube(path), Error);

  write_localized_cube(path, any_cube(largest_localized_size), true);
  EXPECT_NO_THROW(read_localized_cube(path));
  write_localized_cube(path, any_cube(largest_localized_size + 1), true);
  EXPECT_THROW(read_localized_cube(path), Error);

  write_localized_cube(path, any_cube(2), true);
  EXPECT_THROW(write_localized_cube(path, any_cube(2), false), Error);
  std::string bytes;
  {
    std::ifstream file(path, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(file), {});
  }
  fs::remove(path);
  std::ofstream(path, std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  EXPECT_THROW(read_localized_cube(path), Error);
  EXPECT_THROW(read_localized_cube(path_of("missing.exr")), Error);
}

}  // namespace
}  // namespace ivory
