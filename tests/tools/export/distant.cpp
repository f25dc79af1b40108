// ivory export of distant light: a sky of six colours through every target, axis by axis, by each reader's own formula.
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "grid/env/sh9.h"
#include "grid/export/target.h"
#include "grid/io/difmap.h"
#include "tests/tools/export/distant_fixture.h"
#include "tests/tools/export/ktx2_reader.h"
#include "tests/tools/export/node_reader.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

TEST_F(ExportDistant, EveryTargetOfNineLightsTheRightSide) {
  const auto mirrored = [](const V3d& n) { return V3d(-n.x, n.y, n.z); };

  export_to("three.js", "three.json");
  const Values three = nine_flat(json("three.json")["object"]["sh"]);
  expect_sky("three.js", printed, [&](const V3d& n) { return irradiance_at(three, n) / 3.14159265358979; });

  export_to("babylon.js", "babylon.json");
  const auto babylon = [&](const Values& sh) {
    // Signs and constants of its sphericalPolynomial.ts; the light in the left-handed world of a glTF scene.
    const std::array<double, 9> basis{0.282095,  -0.488603, 0.488603,  -0.488603, 1.092548,
                                      -1.092548, 0.315392,  -1.092548, 0.546274};
    Values scaled;
    for (std::size_t i = 0; i < 9; ++i) scaled[i] = sh[i] * (basis[i] / 3.14159265358979);
    return scaled;
  };
  const Values of_babylon = babylon(nine(json("babylon.json")["irradianceCoefficients"]));
  expect_sky("babylon.js", printed, [&](const V3d& n) { return prescaled(of_babylon, mirrored(n)); });

  export_to("playcanvas", "playcanvas.json");
  const Values p = nine_flat(json("playcanvas.json")["ambientSH"]);
  expect_sky("playcanvas", printed, [&](const V3d& n) {
    return p[0] + p[1] * n.x + p[2] * n.y + p[3] * n.z + p[4] * (n.x * n.z) + p[5] * (n.z * n.y) + p[6] * (n.y * n.x) +
           p[7] * (3 * n.z * n.z - 1) + p[8] * (n.x * n.x - n.y * n.y);
  });

  export_to("unity", "unity.json");
  const Json u = json("unity.json")["sh"];
  ASSERT_EQ(u.size(), 27U);
  Values unity;
  for (std::size_t i = 0; i < 9; ++i) unity[i] = V3d(u[i], u[9 + i], u[18 + i]);
  expect_sky("unity", printed, [&](const V3d& n) { return prescaled(unity, mirrored(n)); });

  export_to("filament", "sh.txt");
  std::istringstream lines(bytes_of(path("sh.txt")));
  Values filament;
  for (V3d& v : filament) {
    std::string line;
    ASSERT_TRUE(std::getline(lines, line));
    ASSERT_EQ(std::sscanf(line.c_str(), "( %lf, %lf, %lf); // L", &v.x, &v.y, &v.z), 3) << line;
  }
  expect_sky("filament, text", printed, [&](const V3d& n) { return prescaled(filament, n); });

  export_to("godot", "sky.tres");
  const std::string tres = bytes_of(path("sky.tres"));
  EXPECT_TRUE(tres.starts_with("[gd_resource type=\"LightmapGIData\" format=3]\n\n[resource]\nprobe_data = {\n"));
  const auto list = [&](const std::string& key) {
    std::string text = tres.substr(tres.find("\"" + key + "\": "));
    text = text.substr(text.find('(') + 1);
    text = text.substr(0, text.find(')'));
    std::vector<double> out;
    std::istringstream numbers(text);
    for (std::string number; std::getline(numbers, number, ',');) out.push_back(std::stod(number));
    return out;
  };
  const std::vector<double> colour = list("sh");
  ASSERT_EQ(list("points").size(), 24U);
  ASSERT_EQ(list("tetrahedra").size(), 24U);
  ASSERT_EQ(list("bsp").size() % 6, 0U);
  ASSERT_EQ(colour.size(), 8U * 9 * 4);
  Values godot;
  for (std::size_t i = 0; i < 9; ++i) godot[i] = V3d(colour[4 * i], colour[4 * i + 1], colour[4 * i + 2]);
  expect_sky("godot", printed, [&](const V3d& n) { return irradiance_at(godot, n); });
  for (std::size_t i = 0; i < colour.size(); ++i) EXPECT_EQ(colour[i], colour[i % 36]);
}

// A DifMap loses something on the way to nine coefficients, and says how much; Bevy's cube is the map itself.
TEST_F(ExportDistant, MapsSayWhatTheyLose) {
  const Json result = run("export " + path("difmap.exr") + " --to three.js -o " + path("three.json"));
  const Values three = nine_flat(json("three.json")["object"]["sh"]);
  const DifMap map = read_difmap(path("difmap.exr"));
  // The loss by another sum: over the texels' directions, each channel's difference.
  double squares = 0;
  double sum = 0;
  double weights = 0;
  for (int face = 0; face < 6; ++face)
    for (int row = 0; row < 32; ++row)
      for (int column = 0; column < 32; ++column) {
        const V3f n = cube_texel_direction(32, face, row, column);
        const double weight = cube_texel_solid_angle(32, row, column);
        const Rgb e = map.e.texels[cube_index(32, face, row, column)];
        const V3d read = irradiance_at(three, V3d(n));
        squares += weight * (read - V3d(e)).length2() / 3;
        sum += weight * (e.x + e.y + e.z) / 3;
        weights += weight;
      }
  const double loss = std::sqrt(squares / weights) / (sum / weights);
  EXPECT_GT(loss, 1e-4);
  EXPECT_NEAR(result["loss"].get<double>() / loss, 1, 1e-2);
  // Nine coefficients of the map are those of the sky: bilinear texels of 1/32 of a right angle, 1e-3.
  for (std::size_t i = 0; i < 6; ++i) {
    const V3d e = irradiance_at(three, V3d(axes[i]));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(e[c] / irradiance_polynomial(sh_, V3d(axes[i]))[c], 1, 5e-3);
  }
  const Json cube = run("export " + path("difmap.exr") + " --to bevy -o " + path("cube.ktx2"));
  EXPECT_EQ(cube["size"], 32);
  EXPECT_EQ(cube["loss"], 0);
  const Ktx2Read file = read_ktx2(bytes_of(path("cube.ktx2")));
  for (int i = 0; i < 100; ++i) {
    const int face = i % 6;
    const V3f n = cube_texel_direction(32, face, i % 32, (7 * i) % 32);
    const V4f texel = cube_texel_at(file, V3d(n.x, n.y, -n.z));
    const Rgb e = irradiance(map, n);
    for (unsigned c = 0; c < 3; ++c) EXPECT_NEAR(texel[c] / (e[c] / pi), 1, 1e-3);  // half floats
  }
}

TEST_F(ExportDistant, GltfSceneCarriesTheLight) {
  fs::create_directories(path("lit room"));
  fs::copy_file(scene("room_boxes.gltf"), path("lit room/in.gltf"));
  // Written elsewhere, it still finds what it names beside itself.
  const Json before = Json::parse(bytes_of(scene("room_boxes.gltf")));
  export_to("gltf", "out.gltf", "--scene '" + path("lit room/in.gltf") + "'");
  const Json file = json("out.gltf");
  for (const auto& [key, value] : before.items()) {
    if (key == "buffers" || key == "images" || key == "scenes" || key == "extensions" || key == "extensionsUsed")
      continue;
    EXPECT_EQ(file[key], value) << key;
  }
  for (const Json& buffer : file["buffers"]) {
    const auto uri = buffer.value("uri", std::string("data:"));
    EXPECT_TRUE(uri.starts_with("data:") || uri.starts_with("lit%20room/")) << uri;
  }
  const Json& light = file["extensions"]["EXT_lights_image_based"]["lights"][0];
  for (const Json& entry : file["scenes"]) EXPECT_EQ(entry["extensions"]["EXT_lights_image_based"]["light"], 0);
  const std::array<double, 9> basis{0.282095,  -0.488603, 0.488603,  -0.488603, 1.092548,
                                    -1.092548, 0.315392,  -1.092548, 0.546274};
  Values sh = nine(light["irradianceCoefficients"]);
  for (std::size_t i = 0; i < 9; ++i) sh[i] *= basis[i] / 3.14159265358979;
  expect_sky("glTF", printed, [&](const V3d& n) { return prescaled(sh, V3d(-n.x, n.y, n.z)); });
  // The loader throws without them, and takes the logarithm of the size.
  EXPECT_EQ(light["specularImageSize"], 2);
  EXPECT_EQ(light["specularImages"].size(), 2U);
  for (const Json& level : light["specularImages"]) {
    ASSERT_EQ(level.size(), 6U);
    const auto uri = file["images"][level[0].get<std::size_t>()]["uri"].get<std::string>();
    EXPECT_TRUE(uri.starts_with("data:image/png;base64,iVBORw0KGgo")) << uri;
  }
  // ivory itself still loads the scene.
  EXPECT_EQ(run("info " + path("out.gltf"))["triangles"], run("info " + scene("room_boxes.gltf"))["triangles"]);

  // A binary scene stays one: its other chunk to the byte.
  export_to("gltf", "knot.glb", "--scene " + scene("knot.glb"));
  const std::string knot = bytes_of(scene("knot.glb"));
  const std::string lit = bytes_of(path("knot.glb"));
  EXPECT_EQ(number_at(lit, 8, 4), lit.size());
  const std::size_t json_bytes = number_at(lit, 12, 4);
  EXPECT_EQ(json_bytes % 4, 0U);
  EXPECT_EQ(lit.substr(20 + json_bytes), knot.substr(20 + number_at(knot, 12, 4)));
  EXPECT_EQ(run("info " + path("knot.glb"))["triangles"], run("info " + scene("knot.glb"))["triangles"]);
}

// The readers' own code.
TEST_F(ExportDistant, RealReadersLightTheRightSide) {
  SKIP_WITHOUT_NODE_PACKAGES();
  export_to("three.js", "three.json");
  export_to("babylon.js", "babylon.json");
  export_to("gltf", "scene.gltf", "--scene " + scene("room_boxes.gltf"));
  run("bake sh9 " + path("sky.exr") + " --order 2 --dialect EXT_lights_image_based -o " + path("ext.json"));
  run("bake sh9 " + path("sky.exr") + " --order 2 --dialect three.js -o " + path("three_dialect.json"));
  for (const auto& [reader, file] :
       {std::pair("three", "three.json"), std::pair("three", "three_dialect.json"),
        std::pair("babylon", "babylon.json"), std::pair("babylon", "scene.gltf"), std::pair("babylon", "ext.json")}) {
    const Json read = run_reader("distant.mjs", std::string(reader) + " " + path(file));
    ASSERT_EQ(read.size(), 6U) << file;
    for (std::size_t i = 0; i < 6; ++i) {
      const V3d expected = irradiance_polynomial(sh_, V3d(axes[i])) / 3.14159265358979;
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(read[i][c].get<double>() / expected[int(c)], 1, printed) << file << " axis " << i;
    }
  }
}

TEST_F(ExportDistant, SaysWhatDoesNotGo) {
  const std::string sky = "export " + path("sky.json");
  expect_one_line(sky + " --to unreal -o " + path("x.json"), 2, "three.js");
  expect_one_line(sky + " --to three.js -o " + path("x.ktx2"), 2, ".json");
  expect_one_line(sky + " --to filament -o " + path("x.json"), 2, ".txt, .ktx");
  expect_one_line(sky + " --to nanovdb -o " + path("x.nvdb"), 2, "takes no SH9 or DifMap");
  expect_one_line(sky + " --to gltf -o " + path("x.gltf"), 2, "--scene");
  expect_one_line(sky + " --to gltf --scene " + scene("knot.glb") + " -o " + path("x.gltf"), 2, "both .gltf");
  expect_one_line(sky + " --to unity --scene " + scene("knot.glb") + " -o " + path("x.json"), 2, "--to gltf");
  expect_one_line("export " + path("sky.exr") + " --to three.js -o " + path("x.json"), 1, "is not baked");
  expect_one_line("export " + scene("knot.glb") + " --to three.js -o " + path("x.json"), 1, "is not baked");
  expect_one_line("export " + path("none.json") + " --to three.js -o " + path("x.json"), 1, "does not exist");
  std::ofstream(path("bad.gltf")) << "{}";
  expect_one_line(sky + " --to gltf --scene " + path("bad.gltf") + " -o " + path("x.gltf"), 1, "no glTF scene");
  EXPECT_FALSE(fs::exists(path("x.json")) || fs::exists(path("x.gltf")));
  export_to("three.js", "three.json");
  expect_one_line(sky + " --to three.js -o " + path("three.json"), 1, "--force");
  // All that the table has are in the help.
  const std::string help = run_ivory("export --help").output;
  for (const ExportFormat& format : export_formats())
    EXPECT_NE(help.find(format.holds), std::string::npos) << format.holds;
}

}  // namespace
}  // namespace ivory
