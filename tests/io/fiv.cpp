// FIV tables as files.
#include "grid/io/fiv.h"

#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/folder_test.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

class FivFiles : public FolderTest, public testing::WithParamInterface<int> {
 protected:
  static FivTable example() {
    FivTable table;
    table.size = {5, 4, 3};
    table.hemispheres = GetParam();
    table.center_m = {1, -2, 3};
    table.radius_m = 0.7F;
    table.radii = {0.5F, 1, 4};
    for (std::size_t i = 0; i < fiv_sample_count(table) * std::size_t(3 * fiv_function_count(table.hemispheres)); ++i)
      table.values.push_back(std::sin(float(i)));
    for (std::size_t i = 0; i < table.total.size(); ++i) table.total[i] = float(i);
    for (std::size_t i = 0; i < table.shape.size(); ++i) table.shape[i] = 0.1F * float(i);
    table.coverage = 0.4F;
    table.metadata["mesh"] = std::string("ball.glb");
    return table;
  }
};

TEST_P(FivFiles, ComeBackAsWritten) {
  const FivTable table = example();
  write_fiv(path("a.exr"), table, ExrPrecision::float32, false);
  const FivTable read = read_fiv(path("a.exr"));
  EXPECT_EQ(read.size, table.size);
  EXPECT_EQ(read.hemispheres, table.hemispheres);
  EXPECT_EQ(read.values, table.values);
  EXPECT_EQ(read.radii, table.radii);
  EXPECT_EQ(read.total, table.total);
  EXPECT_EQ(read.shape, table.shape);
  EXPECT_EQ(read.center_m, table.center_m);
  EXPECT_EQ(read.radius_m, table.radius_m);
  EXPECT_EQ(read.coverage, table.coverage);
  EXPECT_EQ(read.metadata.at("mesh"), table.metadata.at("mesh"));
}

TEST_P(FivFiles, HalvesKeepElevenBits) {
  const FivTable table = example();
  write_fiv(path("a.exr"), table, ExrPrecision::float16, false);
  const FivTable read = read_fiv(path("a.exr"));
  for (std::size_t i = 0; i < table.values.size(); ++i)
    EXPECT_NEAR(read.values[i], table.values[i], std::abs(table.values[i]) / 2048 + 3e-8F);
}

TEST_P(FivFiles, TablesThatDoNotFitTogetherAreRefused) {
  const auto expect_refused = [&](const char* what, auto&& spoil) {
    FivTable table = example();
    spoil(table);
    write_fiv(path("b.exr"), table, ExrPrecision::float32, true);
    EXPECT_THROW(read_fiv(path("b.exr")), Error) << what;
  };
  expect_refused("spheres that do not ascend", [](FivTable& t) { t.radii = {1, 0.5F, 4}; });
  expect_refused("a sphere too few", [](FivTable& t) { t.radii.pop_back(); });
  expect_refused("a sphere at the centre", [](FivTable& t) { t.radii[0] = 0; });
  expect_refused("no radius", [](FivTable& t) { t.radius_m = 0; });
  expect_refused("an infinite centre", [](FivTable& t) { t.center_m.x = INFINITY; });
}

// Tables of version 1 do not tell turned crates from those baked.
TEST_P(FivFiles, TablesOfOtherVersionsAreToBeBakedAgain) {
  write_fiv(path("a.exr"), example(), ExrPrecision::float32, false);
  EXPECT_EQ(read_fiv(path("a.exr")).metadata.at("format_version"), MetaValue(std::int64_t(2)));
  ExrAsset asset = read_exr(path("a.exr"), "fiv", "");
  for (const std::int64_t version : {1, 4}) {
    asset.metadata["format_version"] = version;
    asset.lists["shape"].resize(10);
    write_exr(path("a.exr"), asset, ExrPrecision::float32, true);
    try {
      read_fiv(path("a.exr"));
      ADD_FAILURE() << version;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("version " + std::to_string(version)), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("bake it again"), std::string::npos) << error.what();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Hemispheres, FivFiles, testing::Values(1, 6));

}  // namespace
}  // namespace ivory
