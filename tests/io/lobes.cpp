// Lobe tables and sphere sets through files.
#include "grid/io/lobes.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/io/exr.h"
#include "grid/io/json.h"
#include "grid/io/sphere_set.h"
#include "tests/support/paths.h"

namespace ivory {
namespace {

std::string path_of(const std::string& name) {
  std::filesystem::create_directories(output_folder);
  return std::string(output_folder) + "/" + name;
}

void write_text(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

TEST(LobesFile, KeepsTheTable) {
  const LobeTable table = make_lobe_table({5, 9});
  write_lobes(path_of("lobes.exr"), table, {{"method", std::string("moments")}}, true);
  const LobesFile read = read_lobes(path_of("lobes.exr"));
  EXPECT_EQ(read.table.exponent_nodes, 5);
  EXPECT_EQ(read.table.angle_nodes, 9);
  EXPECT_EQ(read.table.values, table.values);
  EXPECT_EQ(std::get<std::string>(read.metadata.at("method")), "moments");
}

TEST(LobesFile, RefusesOtherTables) {
  const LobeTable table = make_lobe_table({5, 9});
  EXPECT_THROW(read_lobes(path_of("absent.exr")), Error);
  ExrAsset asset;
  asset.kind = lobes_kind;
  asset.width = 9;
  asset.height = 25;
  asset.channels = {"integral", "axis", "exponent"};
  asset.values = table.values;
  asset.metadata = {
      {"format_version", std::int64_t(1)}, {"exponent_nodes", std::int64_t(4)}, {"angle_nodes", std::int64_t(9)}};
  write_exr(path_of("bad.exr"), asset, ExrPrecision::float32, true);
  EXPECT_THROW(read_lobes(path_of("bad.exr")), Error);  // 4 nodes do not make 25 rows
  asset.metadata["exponent_nodes"] = std::int64_t(5);
  asset.metadata["format_version"] = std::int64_t(2);
  write_exr(path_of("bad.exr"), asset, ExrPrecision::float32, true);
  EXPECT_THROW(read_lobes(path_of("bad.exr")), Error);
  asset.metadata["format_version"] = std::int64_t(1);
  write_exr(path_of("bad.exr"), asset, ExrPrecision::float32, true);
  EXPECT_NO_THROW(read_lobes(path_of("bad.exr")));
  asset.values[0] = -1;
  write_exr(path_of("bad.exr"), asset, ExrPrecision::float32, true);
  EXPECT_THROW(read_lobes(path_of("bad.exr")), Error);
}

TEST(SpheresFile, KeepsEveryBit) {
  SphereSet set;
  set.spheres = {{V3f(0.1F, -3e-7F, 1e8F), 1e-5F}, {V3f(1.0F / 3, 2, 3), 0.7F}};
  set.metadata = {{"mesh", std::string("a \"quoted\" name\n")}, {"count", std::int64_t(2)}, {"volume_outside", 0.25}};
  write_spheres(path_of("set.json"), set, true);
  EXPECT_EQ(json_asset_kind(path_of("set.json")), "spheres");
  const SphereSet read = read_spheres(path_of("set.json"));
  ASSERT_EQ(read.spheres.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.spheres[i].center, set.spheres[i].center);
    EXPECT_EQ(read.spheres[i].radius_m, set.spheres[i].radius_m);
  }
  for (const auto& [key, value] : set.metadata) EXPECT_EQ(read.metadata.at(key), value) << key;
  EXPECT_THROW(write_spheres(path_of("set.json"), set, false), Error);
}

TEST(SpheresFile, RefusesWhatIsNoSphereSet) {
  const std::string head = R"({"ivory_asset": "spheres", "format_version": 1, "spheres": )";
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("[]"), std::string("{\"spheres\": [[0,0,0,1]]}"),
        std::string(R"({"ivory_asset": "spheres", "format_version": 2, "spheres": [[0,0,0,1]]})"), head + "[]}",
        head + "3}", head + "[[0,0,0]]}", head + "[[0,0,0,0]]}", head + "[[0,0,0,-1]]}", head + "[[0,0,0,\"1\"]]}",
        head + "[[0,0,1e300,1]]}", head + "[[0,0,0,1e-60]]}", head + "[{}]}", std::string(200000, '[')}) {
    write_text(path_of("bad.json"), text);
    EXPECT_THROW(read_spheres(path_of("bad.json")), Error) << text.substr(0, 80);
  }
  EXPECT_THROW(read_spheres(path_of("absent.json")), Error);
  EXPECT_THROW(read_spheres(output_folder), Error);
  EXPECT_EQ(json_asset_kind(path_of("absent.json")), "");
  EXPECT_EQ(json_asset_kind(path_of("bad.json")), "");
  EXPECT_EQ(json_asset_kind(output_folder), "");
}

}  // namespace
}  // namespace ivory
