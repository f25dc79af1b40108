// SH9 and DifMap files: what is written comes back; what is damaged is refused in one line.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/io/difmap.h"
#include "grid/io/export/sh9_dialect.h"
#include "grid/io/json.h"
#include "grid/io/sh9.h"
#include "tests/support/folder_test.h"
#include "tests/support/paths.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class EnvironmentAssets : public FolderTest {
 protected:
  Json json(const std::string& name) const { return Json::parse(std::ifstream(path(name))); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }
};

Sh9Asset random_asset() {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  Sh9Asset asset;
  for (V3d& c : asset.sh.coefficients) c = V3d(normal(random), normal(random), normal(random));
  asset.window = {0.75, 0.5};
  asset.error = {0.0123, 0.0456};
  asset.metadata = {{"environment", std::string("sky.exr")}, {"width", std::int64_t(512)}, {"gain", 0.25}};
  return asset;
}

TEST_F(EnvironmentAssets, Sh9ComesBack) {
  const Sh9Asset asset = random_asset();
  write_sh9(path("a.json"), asset, false);
  EXPECT_THROW(write_sh9(path("a.json"), asset, false), Error);
  EXPECT_EQ(json_asset_kind(path("a.json")), "sh9");
  const Sh9Asset back = read_sh9(path("a.json"));
  EXPECT_EQ(back.sh.coefficients, asset.sh.coefficients);
  EXPECT_EQ(back.order, 2);
  EXPECT_EQ(back.window.band1, 0.75);
  EXPECT_EQ(back.window.band2, 0.5);
  EXPECT_EQ(back.error.average, 0.0123);
  EXPECT_EQ(back.error.maximum, 0.0456);
  for (const auto& [key, value] : asset.metadata) EXPECT_EQ(back.metadata.at(key), value) << key;
  const Json json = this->json("a.json");
  EXPECT_EQ(json["coefficients"].size(), 9U);
  const auto m = sh9_matrices(asset.sh);
  EXPECT_EQ(json["matrices"][2][1][3], m[2][7]);
  write_sh9(path("b.json"), back, false);
  EXPECT_EQ(json, this->json("b.json"));
}

TEST_F(EnvironmentAssets, BadSh9IsRefused) {
  write_sh9(path("good.json"), random_asset(), false);
  const Json good = json("good.json");
  const auto expect = [&](const std::string& text, const std::string& part) {
    const std::string file = write("bad.json", text);
    try {
      read_sh9(file);
      ADD_FAILURE() << "read: " << part;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  };
  expect("", "not JSON");
  expect("{\"format\": \"ivory sh9\",", "not JSON");
  expect("\x89PNG\r\n", "not JSON");
  expect("[1, 2]", "no SH9 file");
  expect("{}", "no SH9 file");
  expect("{\"format\": 5}", "no SH9 file");
  expect(std::string(2 << 20, '['), "too large");
  expect(std::string(1 << 19, '['), "not JSON");
  const auto edited = [&](const std::function<void(Json&)>& edit) {
    Json bad = good;
    edit(bad);
    return bad.dump();
  };
  for (const char* key :
       {"format_version", "order", "window", "average_error", "maximum_error", "coefficients", "matrices"}) {
    expect(edited([&](Json& j) { j.erase(key); }), key);
    expect(edited([&](Json& j) { j[key] = "x"; }), key == std::string("format_version") ? "format_version" : key);
    expect(edited([&](Json& j) { j[key] = nullptr; }), key);
  }
  expect(edited([](Json& j) { j["format_version"] = 2; }), "version 2");
  expect(edited([](Json& j) { j["window"] = {1, 2}; }), "window");
  expect(edited([](Json& j) { j["order"] = 3; }), "order");
  expect(edited([](Json& j) { j["coefficients"].erase(0); }), "9 x 3");
  expect(edited([](Json& j) { j["coefficients"][4].push_back(1); }), "9 x 3");
  expect(edited([](Json& j) { j["coefficients"][4] = 1; }), "9 x 3");
  expect(edited([](Json& j) { j["coefficients"][4][1] = "1"; }), "no number");
  expect(edited([](Json& j) { j["coefficients"][4][1] = 1e300; }), "1e30");
  expect(edited([](Json& j) { j["coefficients"][4][1] = 17; }), "do not belong");
  expect(edited([](Json& j) { j["matrices"][0].erase(0); }), "3 x 4 x 4");
  expect(edited([](Json& j) { j["matrices"][0][3][3] = 1e9; }), "do not belong");
  expect(std::string(good.dump()).replace(good.dump().find("0.0123"), 6, "1e9999"), "");
  EXPECT_THROW(read_sh9(path("missing.json")), Error);
  EXPECT_THROW(read_sh9(path(".")), Error);
}

TEST_F(EnvironmentAssets, DialectsHaveTheirReadersShape) {
  const Sh9Asset asset = random_asset();
  write_sh9_dialect(path("f.json"), asset, Sh9Dialect::filament, false);
  write_sh9_dialect(path("t.json"), asset, Sh9Dialect::three_js, false);
  write_sh9_dialect(path("e.json"), asset, Sh9Dialect::ext_lights_image_based, false);
  const auto f = in_dialect(asset.sh, Sh9Dialect::filament);
  EXPECT_EQ(json("f.json")["irradiance"][8][2], f[8].z);
  const Json t = json("t.json");
  EXPECT_EQ(t["type"], "LightProbe");
  EXPECT_EQ(t["sh"].size(), 27U);
  EXPECT_EQ(t["sh"][3 * 5 + 1], asset.sh.coefficients[5].y);
  EXPECT_EQ(t["metadata"]["type"], "Object");  // what ObjectLoader takes
  EXPECT_EQ(t["object"]["type"], "LightProbe");
  EXPECT_EQ(t["object"]["sh"], t["sh"]);
  EXPECT_EQ(t["object"]["uuid"].get<std::string>().size(), 36U);
  const auto e = in_dialect(asset.sh, Sh9Dialect::ext_lights_image_based);
  EXPECT_EQ(json("e.json")["irradianceCoefficients"][1][0], e[1].x);
  EXPECT_EQ(json("e.json")["intensity"], 1);
  EXPECT_THROW(read_sh9(path("f.json")), Error);
  EXPECT_THROW(write_sh9_dialect(path("f.json"), asset, Sh9Dialect::filament, false), Error);
}

DifMap random_difmap(int size) {
  std::mt19937 random(2);
  std::exponential_distribution<float> value;
  DifMap map;
  map.e = {size, std::vector<Rgb>(std::size_t(6 * size * size))};
  for (Rgb& e : map.e.texels) e = Rgb(value(random), value(random), value(random));
  map.metadata = {{"environment", std::string("sky.exr")}, {"error_bound", 1e-4}};
  return map;
}

TEST_F(EnvironmentAssets, DifMapComesBackAndOthersReadItAsACube) {
  const DifMap map = random_difmap(5);
  write_difmap(path("a.exr"), map, false);
  EXPECT_TRUE(is_difmap(path("a.exr")));
  EXPECT_THROW(write_difmap(path("a.exr"), map, false), Error);
  const DifMap back = read_difmap(path("a.exr"));
  EXPECT_EQ(back.e.size, 5);
  EXPECT_EQ(back.e.texels, map.e.texels);
  for (const auto& [key, value] : map.metadata) EXPECT_EQ(back.metadata.at(key), value) << key;
  const auto input = OIIO::ImageInput::open(path("a.exr"));
  ASSERT_TRUE(input);
  EXPECT_EQ(input->spec().width, 5);
  EXPECT_EQ(input->spec().height, 30);
  EXPECT_EQ(input->spec().get_string_attribute("textureformat"), "CubeFace Environment");
}

TEST_F(EnvironmentAssets, BadDifMapIsRefused) {
  const DifMap map = random_difmap(8);
  write_difmap(path("a.exr"), map, false);
  fs::copy_file(path("a.exr"), path("cut.exr"));
  fs::resize_file(path("cut.exr"), fs::file_size(path("cut.exr")) / 2);
  EXPECT_THROW(read_difmap(path("cut.exr")), Error);
  EXPECT_THROW(read_difmap(write("text.exr", "no picture")), Error);
  EXPECT_FALSE(is_difmap(path("text.exr")));
  EXPECT_THROW(read_difmap(path("missing.exr")), Error);
  DifMap negative = map;
  negative.e.texels[7].y = -1;
  write_difmap(path("negative.exr"), negative, false);
  EXPECT_THROW(read_difmap(path("negative.exr")), Error);
}

}  // namespace
}  // namespace ivory
