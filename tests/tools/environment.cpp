// ivory bake sh9, bake difmap, probe and info on them, --layout, bench sh9: good and bad input.
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/environment_pictures.h"
#include "tests/support/folder_test.h"
#include "tests/support/paths.h"
#include "tests/support/run_ivory.h"
#include "tracer/image/file.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class EnvironmentTools : public FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    std::ofstream(path("p.csv")) << "x,y,z,nx,ny,nz\n0,0,0,0,1,0\n5,-7,9,0,-1,0\n0,0,0,1,0,0\n1,0,0,0.6,0,-0.8\n";
  }
  void write(const std::string& name, EnvironmentLayout layout, int detail,
             const std::function<Rgb(const V3d&)>& radiance) const {
    const Picture picture = make_picture(layout, detail, radiance);
    Film film;
    film.width = picture.width;
    film.height = picture.height;
    film.pixels = picture.texels;
    write_image(path(name), film, 0, {}, true);
  }
  Json run(const std::string& arguments) const {
    const RunResult result = run_ivory(arguments + " --json", false);
    EXPECT_EQ(result.exit_code, 0) << arguments;
    const Json json = Json::parse(result.output, nullptr, false);
    EXPECT_FALSE(json.is_discarded()) << arguments << '\n' << result.output;
    return json;
  }
  void expect_refused(const std::string& arguments, int exit_code, const std::string& part) const {
    const RunResult result = run_ivory(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << arguments << '\n' << result.output;
    EXPECT_TRUE(result.output.starts_with("ivory: ")) << result.output;
    EXPECT_NE(result.output.find(part), std::string::npos) << arguments << '\n' << result.output;
    EXPECT_EQ(std::count(result.output.begin(), result.output.end(), '\n'), 1) << result.output;
  }
  // r, g, b of each point.
  std::vector<V3d> probed(const std::string& source) const {
    run("probe " + path(source) + " --points " + path("p.csv") + " -o " + path("out.csv") + " --force");
    std::ifstream file(path("out.csv"));
    std::string line;
    std::getline(file, line);
    EXPECT_EQ(line, "x,y,z,nx,ny,nz,r,g,b,r_se,g_se,b_se");
    std::vector<V3d> out;
    while (std::getline(file, line)) {
      std::istringstream cells(line);
      std::vector<double> values;
      for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::stod(cell));
      out.emplace_back(values.at(6), values.at(7), values.at(8));
      EXPECT_EQ(values.at(9) + values.at(10) + values.at(11), 0);
    }
    return out;
  }
  std::string bytes(const std::string& name) const {
    std::ifstream file(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

// L = 3 + 2 y in red, 1 + x in green, 2 - z in blue: E = pi a + 2 pi/3 b (n . axis), exactly of order 1.
Rgb slope(const V3d& w) { return Rgb(float(3 + 2 * w.y), float(1 + w.x), float(2 - w.z)); }
V3d slope_irradiance(const V3d& n) {
  constexpr double p = 3.14159265358979323846;
  return V3d(3 * p + 4 * p / 3 * n.y, p + 2 * p / 3 * n.x, 2 * p - 2 * p / 3 * n.z);
}

TEST_F(EnvironmentTools, EveryLayoutBakesTheSameIrradiance) {
  const std::vector<V3d> normals{{0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {0.6, 0, -0.8}};
  for (const EnvironmentLayout layout : all_layouts) {
    const std::string label(name_of(layout));
    write(label + ".exr", layout, 64, slope);
    const Json sh9 = run("bake sh9 " + path(label + ".exr") + " -o " + path(label + ".json"));
    EXPECT_EQ(sh9["layout"], label);
    EXPECT_EQ(sh9["order"], 1) << label;  // already exact
    EXPECT_LT(sh9["maximum_error"], 1e-4) << label;
    EXPECT_GT(sh9["read_seconds"], 0) << label;
    EXPECT_GT(sh9["projection_seconds"], 0) << label;
    const Json difmap =
        run("bake difmap " + path(label + ".exr") + " -o " + path(label + "_difmap.exr") + " --size 32");
    EXPECT_LT(difmap["sh9_maximum_error"], 1e-4) << label;
    EXPECT_GT(difmap["read_seconds"], 0) << label;
    EXPECT_GT(difmap["bake_seconds"], 0) << label;
    const auto a = probed(label + ".json");
    const auto b = probed(label + "_difmap.exr");
    ASSERT_EQ(a.size(), normals.size());
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const V3d e = slope_irradiance(normals[i]);
      for (int c = 0; c < 3; ++c) {
        // Texels of 1/64 of a right angle: 1e-4 of the slope. On the difmap the normals -y and -z lie between four
        // texels, each (1/32)^2 less of the slope, which is up to 0.8 of E: 8e-4 more.
        EXPECT_NEAR(a[i][c] / e[c], 1, 2e-4) << label << i;
        EXPECT_NEAR(b[i][c] / e[c], 1, 1.2e-3) << label << i;
      }
    }
    const Json info = run("info " + path(label + ".json"));
    EXPECT_EQ(info["kind"], "sh9");
    EXPECT_EQ(info["environment_layout"], label);
    EXPECT_EQ(info["coefficients"].size(), 9U);
    EXPECT_EQ(run("info " + path(label + "_difmap.exr"))["kind"], "difmap");
  }
}

// The map itself, summed over its texels.
TEST_F(EnvironmentTools, ProbesEnvironmentMapsThemselves) {
  const std::vector<V3d> normals{{0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {0.6, 0, -0.8}};
  for (const EnvironmentLayout layout : all_layouts) {
    write("map.exr", layout, 32, slope);
    const auto e = probed("map.exr");
    ASSERT_EQ(e.size(), normals.size());
    for (std::size_t i = 0; i < normals.size(); ++i) {
      // Texels of 1/32 of a right angle: 4e-4 of the slope.
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(e[i][c] / slope_irradiance(normals[i])[c], 1, 8e-4) << name_of(layout) << i;
    }
  }
  const Json json = run("probe " + path("map.exr") + " --points " + path("p.csv") + " -o " + path("e.csv"));
  EXPECT_EQ(json["source"], "environment");
  EXPECT_EQ(json["layout"], "cube_row");
  EXPECT_LT(json["error_bound_lux"], 1e-4);
}

TEST_F(EnvironmentTools, OrderWindowAndErrorsOfOneSmallLight) {
  // About one texel: the worst there is.
  write("sun.exr", EnvironmentLayout::latlong, 32,
        [](const V3d& w) { return w.dot(V3d(0.6, 0.48, 0.64)) > 0.9995 ? Rgb(1e4F, 1e4F, 1e4F) : Rgb(0, 0, 0); });
  const std::string bake = "bake sh9 " + path("sun.exr") + " --force -o " + path("s.json");
  const Json whole = run(bake);
  EXPECT_EQ(whole["order"], 2);
  EXPECT_EQ(whole["enough"], false);
  // 9.4 %, less what the light's own width (1.8 degrees) and the spacing of the normals leave of it.
  EXPECT_NEAR(whole["maximum_error"].get<double>(), 0.088, 0.006);
  EXPECT_NEAR(whole["maximum_error_of_mean_irradiance"].get<double>(), 4 * whole["maximum_error"].get<double>(), 1e-9);
  EXPECT_LT(whole["least_irradiance_lux"], 0);
  EXPECT_EQ(run(bake + " --max-error 0.5")["order"], 0);
  const double first = run(bake + " --order 1")["average_error"];
  const double zeroth = run(bake + " --order 0")["average_error"];
  EXPECT_GT(zeroth, first);
  EXPECT_GT(first, whole["average_error"].get<double>());
  const Json soft = run(bake + " --window auto");
  EXPECT_GE(soft["least_irradiance_lux"].get<double>(), -1e-9);
  EXPECT_LT(soft["window"][1], 1);
  // Less harm than the Hann window that one light asks for.
  EXPECT_LT(soft["average_error"], run(bake + " --window 2")["average_error"]);
  const Json hann = run(bake + " --window 3")["window"];
  EXPECT_NEAR(hann[1].get<double>(), 0.75, 1e-12);
  EXPECT_NEAR(hann[2].get<double>(), 0.25, 1e-12);
  EXPECT_EQ(run("info " + path("s.json"))["window"], hann);
}

TEST_F(EnvironmentTools, TheSameCommandGivesTheSameBytes) {
  write("e.exr", EnvironmentLayout::angular, 16, slope);
  for (const std::string kind : {"sh9", "difmap"}) {
    const std::string extension = kind == "sh9" ? ".json" : ".exr";
    for (const std::string threads : {"1", "3"})
      run("bake " + kind + " " + path("e.exr") + " --threads " + threads + " -o " + path(kind + threads + extension));
    EXPECT_EQ(bytes(kind + "1" + extension), bytes(kind + "3" + extension));
    EXPECT_NE(bytes(kind + "1" + extension), "");
  }
}

TEST_F(EnvironmentTools, ScenesAcceptEveryLayout) {
  const std::string scene = std::string(source_folder) + "/scenes/leak_axis.gltf";
  for (const EnvironmentLayout layout : {EnvironmentLayout::latlong, EnvironmentLayout::horizontal_cross}) {
    const std::string label(name_of(layout));
    write(label + ".exr", layout, 32, slope);
    run("bake grid " + scene + " --env " + path(label + ".exr") + " --layout " + label +
        " --resolution 4 --photons 2k --direct -o " + path(label + ".vdb"));
    EXPECT_EQ(run("info " + path(label + ".vdb"))["environment_layout"], label);
  }
}

// End to end: the path tracer, which reads the map resampled to lat-long, at a place that the scene does not shade,
// against the DifMap of the map as it is.
TEST_F(EnvironmentTools, DifMapIsWhatThePathTracerFindsFarFromEverything) {
  std::mt19937 random(5);
  std::exponential_distribution<double> value;
  for (const EnvironmentLayout layout : {EnvironmentLayout::vertical_cross, EnvironmentLayout::angular}) {
    write("rough.exr", layout, 8, [&](const V3d& w) { return slope(w) * float(value(random)); });
    std::ofstream(path("far.csv")) << "x,y,z,nx,ny,nz\n0,5000,0,0,1,0\n0,5000,0,1,0,0\n0,5000,0,0,0,1\n"
                                      "0,5000,0,-0.6,0.3,0.5\n0,-5000,0,0,-1,0\n0,-5000,0,0.2,-0.1,-0.9\n";
    run("bake difmap " + path("rough.exr") + " --force -o " + path("rough_difmap.exr"));
    const std::string tail = " --points " + path("far.csv") + " --force -o ";
    run("probe " + path("rough_difmap.exr") + tail + path("map.csv"));
    run("probe " + std::string(source_folder) + "/scenes/cornell_box.gltf --env " + path("rough.exr") +
        " --samples 4k" + tail + path("traced.csv"));
    const auto rows = [&](const std::string& name) {
      std::ifstream file(path(name));
      std::vector<std::vector<double>> out;
      std::string line;
      std::getline(file, line);
      while (std::getline(file, line)) {
        std::istringstream cells(line);
        out.emplace_back();
        for (std::string cell; std::getline(cells, cell, ',');) out.back().push_back(std::stod(cell));
      }
      return out;
    };
    const auto map = rows("map.csv");
    const auto traced = rows("traced.csv");
    ASSERT_EQ(map.size(), 6U);
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t c = 6; c < 9; ++c) {
        // 36 comparisons at 5 standard errors: a false alarm in 5e4 runs. The map's own interpolation and the
        // resampling move texels by a fraction of their width: 0.5 % of E.
        EXPECT_NEAR(map[i][c], traced[i][c], 5 * traced[i][c + 3] + 5e-3 * map[i][c]) << name_of(layout) << i;
        EXPECT_GT(traced[i][c + 3], 0);
        EXPECT_LT(traced[i][c + 3], 0.05 * traced[i][c]);
      }
    }
  }
}

TEST_F(EnvironmentTools, BadInputIsOneLine) {
  write("good.exr", EnvironmentLayout::latlong, 8, slope);
  write("cross.exr", EnvironmentLayout::vertical_cross, 8, slope);
  write("black.exr", EnvironmentLayout::latlong, 8, [](const V3d&) { return Rgb(0, 0, 0); });
  const std::string good = path("good.exr");
  const std::string json = " -o " + path("x.json");
  const std::string exr = " -o " + path("x.exr");
  expect_refused("bake sh9 " + good, 2, "--output");
  expect_refused("bake sh9 " + good + " -o " + path("x.exr"), 2, ".json");
  expect_refused("bake difmap " + good + json, 2, ".exr");
  expect_refused("bake sh9 " + good + json + " --layout fisheye", 2, "fisheye");
  expect_refused("bake sh9 " + good + json + " --layout cube", 1, "1 face wide and 6 high");
  expect_refused("bake difmap " + path("cross.exr") + exr + " --layout latlong", 1, "twice as wide as high");
  expect_refused("bake sh9 " + good + json + " --order 3", 2, "--order");
  expect_refused("bake sh9 " + good + json + " --order 1 --max-error 0.1", 2, "--max-error");
  for (const char* width : {"1.5", "-3", "nan", "inf", "auto2", "''", "2x"})
    expect_refused("bake sh9 " + good + json + " --window " + width, 2, "--window");
  expect_refused("bake sh9 " + good + json + " --dialect unreal", 2, "--dialect");
  expect_refused("bake difmap " + good + exr + " --size 0", 2, "--size");
  expect_refused("bake difmap " + good + exr + " --size 5000", 2, "--size");
  expect_refused("bake sh9 " + path("missing.exr") + json, 1, "missing.exr");
  expect_refused("bake sh9 " + std::string(source_folder) + "/README.md" + json, 1, "README.md");
  fs::copy_file(good, path("cut.exr"));
  fs::resize_file(path("cut.exr"), fs::file_size(good) / 2);
  expect_refused("bake sh9 " + path("cut.exr") + json, 1, "cut.exr");
  expect_refused("bake difmap " + path("cut.exr") + exr, 1, "cut.exr");
  expect_refused("render " + std::string(source_folder) + "/scenes/leak_axis.gltf --layout cube" + exr, 2, "--env");
  EXPECT_FALSE(fs::exists(path("x.json")));
  EXPECT_FALSE(fs::exists(path("x.exr")));

  // No light is no error.
  EXPECT_EQ(run("bake sh9 " + path("black.exr") + json)["order"], 0);
  EXPECT_EQ(probed("x.json")[0], V3d(0, 0, 0));
  run("bake difmap " + path("black.exr") + exr);
  EXPECT_EQ(probed("x.exr")[1], V3d(0, 0, 0));

  const std::string points = " --points " + path("p.csv") + " -o " + path("y.csv");
  expect_refused("bake sh9 " + good + json, 1, "--force");
  expect_refused("bake sh9 " + path("x.exr") + " -o " + path("y.json"), 1, "is baked (difmap)");
  expect_refused("probe " + path("x.json") + points + " --indirect-only", 2, "--indirect-only");
  expect_refused("probe " + path("x.exr") + points + " --guard off", 2, "--guard");
  expect_refused("probe " + good + points + " --indirect-only", 2, "--indirect-only");
  expect_refused("probe " + path("cut.exr") + points, 1, "cut.exr");
  expect_refused("probe " + path("missing.exr") + points, 1, "missing.exr");
  std::ofstream(path("bad.json")) << "{\"format\": \"ivory sh9\"}";
  expect_refused("probe " + path("bad.json") + points, 1, "bad.json");
  expect_refused("info " + path("bad.json"), 1, "bad.json");
  EXPECT_FALSE(fs::exists(path("y.csv")));
}

// A map of 2 everywhere that was exposed by 2: E = pi, and everyone who takes it says so.
TEST_F(EnvironmentTools, EveryCommandSaysWhatItTookItsMapFor) {
  {
    std::ofstream file(path("exposed.hdr"), std::ios::binary);
    file << "#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
    for (int i = 0; i < 8; ++i) file << "\x80\x80\x80\x82";
  }
  const std::string map = path("exposed.hdr");
  const std::string scene = std::string(source_folder) + "/scenes/leak_axis.gltf";
  const auto expect = [&](const std::string& command, const std::string& output) {
    const Json result = run(command + " --force -o " + path(output));
    ASSERT_EQ(result["warnings"].size(), 1U) << command << result;
    EXPECT_NE(result["warnings"][0].get<std::string>().find("exposed.hdr: was exposed by 2 "), std::string::npos)
        << result["warnings"];
    if (output.ends_with("csv")) return;
    EXPECT_NE(bytes(output).find("exposed.hdr: was exposed by 2 "), std::string::npos) << command;
  };
  const std::string points = " --points " + path("p.csv");
  expect("probe " + map + points, "e.csv");
  expect("bake sh9 " + map, "e.json");
  expect("bake difmap " + map + " --size 4", "e.exr");
  for (const V3d& e : probed("e.exr"))
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(e[c], 3.14159265, 1e-3);
  const std::string env = " --env " + map;
  expect("bake fiv " + scene + env + " --samples 4,3,2 --silhouette 8", "t.exr");
  expect("bake grid " + scene + env + " --resolution 2 --photons 100 --direct", "t.vdb");
}

TEST_F(EnvironmentTools, BenchMeasuresTheProjectionBesideASum) {
  const Json result = run("bench sh9 --size 256x128 --rounds 3");
  EXPECT_GT(result["ratio"], 0);
  EXPECT_EQ(result["width"], 256);
}

}  // namespace
}  // namespace ivory
