// Assets as OpenEXR files: what is written comes back, what is damaged or foreign is refused.
#include "grid/io/exr.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/folder_test.h"
#include "tests/support/full_disk.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

class ExrFiles : public FolderTest {
 protected:
};

ExrAsset example() {
  ExrAsset asset;
  asset.kind = "test";
  asset.width = 5;
  asset.height = 3;
  asset.channels = {"zeta", "alpha.r"};  // not in alphabetical order
  for (int i = 0; i < 30; ++i) asset.values.push_back(0.1F * float(i) - 1);
  asset.metadata = {{"radius_m", 0.1}, {"count", std::int64_t(7)}, {"scene", std::string("room.glb")}};
  asset.lists = {{"radii_m", {0.25F, 0.5F, 1.1F}}};
  return asset;
}

void expect_error(const std::string& path, const std::string& kind, const std::string& words) {
  try {
    read_exr(path, kind, "bake it");
    ADD_FAILURE() << "no error: " << words;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
  }
}

// OpenEXR's own stream keeps a small file to itself until it is closed, and then says nothing.
TEST_F(ExrFiles, FullDiskLeavesWhatWasThere) {
  write_exr(path("a.exr"), example(), ExrPrecision::float32, false);
  const std::uintmax_t size = fs::file_size(path("a.exr"));
  ExrAsset other = example();
  other.values[3] = 5;
  {
    const FullDisk limit(300);
    EXPECT_THROW(write_exr(path("a.exr"), other, ExrPrecision::float32, true), Error);
  }
  EXPECT_EQ(fs::file_size(path("a.exr")), size);
  EXPECT_EQ(read_exr(path("a.exr"), "test", "bake it").values, example().values);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(ExrFiles, ComeBackAsWritten) {
  const ExrAsset asset = example();
  write_exr(path("a.exr"), asset, ExrPrecision::float32, false);
  const ExrAsset read = read_exr(path("a.exr"), "test", "bake it");
  EXPECT_EQ(read.width, asset.width);
  EXPECT_EQ(read.height, asset.height);
  EXPECT_EQ(read.channels, asset.channels);
  EXPECT_EQ(read.values, asset.values);
  EXPECT_EQ(read.metadata, asset.metadata);
  EXPECT_EQ(read.lists, asset.lists);
  EXPECT_EQ(exr_asset_kind(path("a.exr")), "test");
}

TEST_F(ExrFiles, HalvesRoundToElevenBits) {
  const ExrAsset asset = example();
  write_exr(path("a.exr"), asset, ExrPrecision::float16, false);
  const ExrAsset read = read_exr(path("a.exr"), "test", "bake it");
  // Half a unit in the last of 11 bits, and the spacing of subnormal halves near zero.
  for (std::size_t i = 0; i < asset.values.size(); ++i)
    EXPECT_NEAR(read.values[i], asset.values[i], std::abs(asset.values[i]) / 2048 + 3e-8F);
}

TEST_F(ExrFiles, LargeIntegersComeBackAsText) {
  ExrAsset asset = example();
  asset.metadata["seed"] = std::int64_t(1) << 40;
  write_exr(path("a.exr"), asset, ExrPrecision::float32, false);
  EXPECT_EQ(read_exr(path("a.exr"), "test", "bake it").metadata.at("seed"), MetaValue(std::string("1099511627776")));
}

TEST_F(ExrFiles, AreWrittenWholeOrNotAtAll) {
  ExrAsset asset = example();
  asset.values[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(write_exr(path("a.exr"), asset, ExrPrecision::float32, false), Error);
  asset.values[4] = 1e6F;
  EXPECT_THROW(write_exr(path("a.exr"), asset, ExrPrecision::float16, false), Error);
  EXPECT_TRUE(fs::is_empty(folder_));
  write_exr(path("a.exr"), asset, ExrPrecision::float32, false);
  EXPECT_THROW(write_exr(path("a.exr"), asset, ExrPrecision::float32, false), Error);
  write_exr(path("a.exr"), asset, ExrPrecision::float32, true);
}

TEST_F(ExrFiles, ForeignKindsAreRefused) {
  write_exr(path("a.exr"), example(), ExrPrecision::float32, false);
  expect_error(path("a.exr"), "fiv", "holds test, not fiv");
  std::ofstream(path("b.exr")) << "no picture";
  expect_error(path("b.exr"), "fiv", "cannot be read as an OpenEXR file");
  expect_error(path("missing.exr"), "fiv", "cannot be read");
  EXPECT_EQ(exr_asset_kind(path("b.exr")), "");
}

// Every byte of a small file, one at a time: read as before (bytes nobody reads), or refused.
TEST_F(ExrFiles, DamageNeverPassesUnnoticed) {
  const ExrAsset asset = example();
  write_exr(path("a.exr"), asset, ExrPrecision::float32, false);
  std::ifstream in(path("a.exr"), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const auto read_back = [&](const std::string& damaged) {
    std::ofstream(path("b.exr"), std::ios::binary | std::ios::trunc) << damaged;
    try {
      const ExrAsset read = read_exr(path("b.exr"), "test", "bake it");
      EXPECT_EQ(read.values, asset.values);
      EXPECT_EQ(read.metadata, asset.metadata);
      EXPECT_EQ(read.lists, asset.lists);
    } catch (const Error&) {
    }
  };
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = char(damaged[i] ^ 0x41);
    read_back(damaged);
    if (i % 16 == 0) read_back(bytes.substr(0, i));
  }
}

}  // namespace
}  // namespace ivory
