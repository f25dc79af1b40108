// ivory view without a window, as a script meets it: what it draws, against ivory render and against itself.
#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "grid/base/types.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/paths.h"
#include "tests/support/view_command.h"
#include "tracer/image/compare.h"
#include "tracer/image/file.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

double largest_difference(const Film& a, const Film& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) largest = std::max(largest, double(std::abs(a.pixels[i][c] - b.pixels[i][c])));
  }
  return largest;
}

TEST_F(ViewCommand, SameCommandGivesTheSameBytes) {
  for (const char* extension : {"exr", "png"}) {
    const std::string common = room() + " " + grid() + " --samples 2 --object " + scene("knot.glb") + "@0,0.2,0 -o ";
    const std::string one = path(std::string("one.") + extension);
    const std::string two = path(std::string("two.") + extension);
    view(common + one);
    view(common + two + " --threads 1");
    EXPECT_FALSE(bytes_of(one).empty());
    EXPECT_TRUE(bytes_of(one) == bytes_of(two)) << extension;
  }
}

TEST_F(ViewCommand, DrawsWhatRenderRenders) {
  const std::string knot = " --object " + scene("knot.glb") + "@0.5,0.1,0.3";
  for (const std::string& how :
       {std::string("--guard planes"), std::string("--guard off"), "--guard planes --interpolation tricubic" + knot,
        "--guard off --interpolation tricubic" + knot, std::string("--guard off --reconstruction paper")}) {
    const std::string reference = path("r.exr");
    run("render " + room() + " --method direct --grid " + grid() + " --indirect-only --size 160x120 --samples 64 " +
        "--threads 2 --force -o " + reference + " " + how);
    const Json result = view(room() + " --grid " + grid() + " --method direct --indirect-only --samples 16 " + how +
                             " --reference " + reference + " -o " + path("v.exr"));
    // Points in a pixel differ, 16 here and 64 there, which edges show; half floats and the hardware's filter add
    // about 1e-3. Drawn with another guard the picture is 0.03 and more away.
    EXPECT_LT(result.at("nrmse").get<double>(), 0.01) << how;
    EXPECT_NEAR(result.at("bias").get<double>(), 0, 1e-3) << how;
    const Json compared = run("compare " + path("v.exr") + " " + reference);
    EXPECT_NEAR(compared.at("nrmse").get<double>(), result.at("nrmse").get<double>(), 1e-6) << how;
  }
}

TEST_F(ViewCommand, DrawsOtherMethodsAsRenderDoes) {
  const std::string size = " --size 120x90 --threads 2 --force --samples ";
  const std::string sky = scene("sky.hdr");
  const std::string knot = " --object " + scene("knot.glb");
  run("bake fiv " + scene("knot.glb") + " --env " + sky + " -o " + path("knot.exr") +
      " --samples 16,9,8 --hemispheres 6");
  run("bake cubemap " + room() + " --at 0.3,1.2,0.2 -o " + path("cube.exr") + " --size 4");
  struct Case {
    std::string scene;
    std::string how;
  };
  for (const Case& c :
       {Case{scene("plaza.gltf"), "--method fiv --env " + sky + knot + " --occluder knot=" + path("knot.exr")},
        // Direct light with shadow maps too.
        Case{room(), "--method cubemap --cubemap " + path("cube.exr") + " --guard planes --grid " + grid() + knot +
                         "@0.3,0.2,0.2"},
        Case{scene("plaza.gltf"), "--method lobes --sphere-light 0.5,3,0.5,0.4,10,10,10"}}) {
    const std::string reference = path("r.exr");
    run("render " + c.scene + " " + c.how + size + "64 -o " + reference);
    const Json result =
        run("view --headless " + c.scene + " " + c.how + size + "64 -o " + path("v.exr") + " --reference " + reference);
    // What edges and the shadow maps' texels differ by, at this small size.
    EXPECT_LT(result.at("nrmse").get<double>(), 0.01) << c.how;
  }
}

TEST_F(ViewCommand, ImagesAreTakenForWhatTheirShapeSays) {
  const Json result = view(scene("plaza.gltf") + " " + scene("sky.hdr") + " --samples 1 -o " + path("e.png"));
  EXPECT_EQ(result.at("environment"), "sky.hdr");
  EXPECT_EQ(result.at("objects").at(0).at("method"), "grid");
  view(room() + " --method constant --samples 1 -o " + path("reference.exr"));
  const Json compared =
      view(room() + " " + path("reference.exr") + " --method constant --samples 1 -o " + path("again.exr"));
  EXPECT_EQ(compared.at("nrmse"), 0);
}

TEST_F(ViewCommand, CameraIsThatOfRender) {
  // What shines is seen as it is by both, wherever it stands.
  for (const std::string& camera : {std::string("--camera 0"), std::string()}) {
    const std::string reference = path("r.exr");
    const std::string cornell = scene("cornell_box.gltf") + " " + camera + " --size 160x120 --force ";
    run("render " + cornell + "--method path --samples 4 --threads 2 -o " + reference);
    run("view --headless " + cornell + "--method none --samples 64 -o " + path("v.exr"));
    const Film rendered = read_image(reference);
    const Film viewed = read_image(path("v.exr"));
    // The lamp is the only thing that bright.
    const auto centre_of_lamp = [](const Film& f) {
      V2f sum(0, 0);
      float count = 0;
      for (int y = 0; y < f.height; ++y) {
        for (int x = 0; x < f.width; ++x) {
          if (luminance(f.at(x, y)) < 5) continue;
          sum += V2f(float(x), float(y));
          ++count;
        }
      }
      return sum / count;
    };
    EXPECT_LT((centre_of_lamp(rendered) - centre_of_lamp(viewed)).length(), 0.5F);
  }
}

TEST_F(ViewCommand, IrradianceIsWhatSurfacesReflect) {
  const std::string common = room() + " " + grid() + " --samples 1 ";
  const Film e = film(common + "--debug irradiance");
  const Film l = film(common + "--indirect-only");
  constexpr float albedo = 0.7F;  // of everything in the room
  Film reflected = e;
  for (Rgb& pixel : reflected.pixels) pixel *= albedo / pi;
  EXPECT_LT(compare_images(reflected, l).nrmse, 1e-5);
}

TEST_F(ViewCommand, GuardViewIsTheDifferenceThatTheGuardMakes) {
  const std::string common = room() + " " + grid() + " --samples 1 ";
  const Film off = film(common + "--debug irradiance --guard off");
  const Film on = film(common + "--debug irradiance --guard planes");
  const Film shown = film(common + "--debug guard");
  double largest = 0;
  for (std::size_t i = 0; i < shown.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const float expected = off.pixels[i][c] - on.pixels[i][c];
      largest = std::max(largest, double(std::abs(expected)));
      EXPECT_NEAR(shown.pixels[i][c], expected, 1e-4F);
    }
  }
  EXPECT_GT(largest, 0.1);  // lux: the guard makes a difference here
}

TEST_F(ViewCommand, SharesLieBetweenNothingAndAll) {
  for (const char* debug : {"kept", "bracket"}) {
    const Film shown = film(room() + " " + grid() + " --samples 1 --debug " + debug);
    float least = 1;
    float greatest = 0;
    for (const Rgb& pixel : shown.pixels) {
      least = std::min(least, pixel.x);
      greatest = std::max(greatest, pixel.x);
    }
    EXPECT_GE(least, 0) << debug;
    EXPECT_LE(greatest, 1.00001F) << debug;
    EXPECT_GT(greatest, least + 0.2F) << debug;
  }
}

TEST_F(ViewCommand, DifferenceIsPictureLessReference) {
  const std::string common = room() + " " + grid() + " --samples 1 ";
  view(common + "--indirect-only -o " + path("with.exr"));
  const Film with = read_image(path("with.exr"));
  const Film without = film(common + "--indirect-only --guard off");
  const Film shown = film(common + "--indirect-only --guard off --debug difference --reference " + path("with.exr"));
  Film expected = without;
  for (std::size_t i = 0; i < expected.pixels.size(); ++i) expected.pixels[i] -= with.pixels[i];
  EXPECT_EQ(largest_difference(shown, expected), 0);
}

TEST_F(ViewCommand, EveryDebugViewDrawsSomethingElse) {
  const std::string common = room() + " " + grid() + " --samples 1 --exposure 0 -o " + path("d.png") + " ";
  std::vector<std::string> pictures;
  for (const char* debug :
       {"none", "irradiance", "stored", "bracket", "kept", "guard", "vertices", "validity", "vectors"}) {
    view(common + "--debug " + debug);
    pictures.push_back(bytes_of(path("d.png")));
    for (std::size_t i = 0; i + 1 < pictures.size(); ++i) EXPECT_TRUE(pictures[i] != pictures.back()) << debug;
  }
  view(common + "--debug irradiance --false-color");
  EXPECT_TRUE(bytes_of(path("d.png")) != pictures[1]);
}

TEST_F(ViewCommand, ToneCurvesAndLinearFilesAreApart) {
  const std::string common = room() + " " + grid() + " --samples 1 ";
  const Film linear = film(common + "--exposure 0");
  EXPECT_EQ(largest_difference(linear, film(common + "--exposure 5 --tone aces")), 0);
  std::vector<std::string> pictures;
  for (const char* tone : {"neutral", "linear", "reinhard", "aces"}) {
    view(common + "--exposure 2 -o " + path("t.png") + " --tone " + tone);
    pictures.push_back(bytes_of(path("t.png")));
    for (std::size_t i = 0; i + 1 < pictures.size(); ++i) EXPECT_TRUE(pictures[i] != pictures.back()) << tone;
  }
  // The curve of ivory render's own pictures, from the same light: PNGs differ by rounding to 8 bits alone.
  write_image(path("expected.png"), linear, 2, {}, true);
  view(common + "--exposure 2 -o " + path("t.png"));
  EXPECT_LE(largest_difference(read_image(path("t.png")), read_image(path("expected.png"))), 1.001 / 255);
}

TEST_F(ViewCommand, ObjectsMoveOnTheirPaths) {
  const std::string command = room() + " --method constant --samples 1 --frames 3 --fps 1 --object " +
                              scene("knot.glb") + "@0,0.5,0 --path line:1,0,0,4 -o " + path("f_%02d.png");
  const Json result = view(command);
  EXPECT_EQ(result.at("outputs").size(), 3U);
  for (const char* name : {"f_00.png", "f_01.png", "f_02.png"}) EXPECT_TRUE(fs::exists(path(name))) << name;
  EXPECT_TRUE(bytes_of(path("f_00.png")) != bytes_of(path("f_01.png")));
  // Half of the period after the start it is there.
  const Json& offset = result.at("objects").at(1).at("offset_m");
  EXPECT_NEAR(offset.at(0).get<double>(), 1, 1e-6);
  EXPECT_NEAR(offset.at(1).get<double>(), 0.5, 1e-6);
}

TEST_F(ViewCommand, NodesOfTheSceneAreObjects) {
  const std::string plain = path("plain.png");
  view(room() + " --method constant --samples 1 --exposure 0 -o " + plain);
  // Taken out and put back where it was, nothing changes but the order of drawing.
  for (const Json& node : Json::parse(bytes_of(room())).at("nodes")) {
    if (!node.contains("mesh") || !node.contains("name")) continue;
    const std::string name = node.at("name").get<std::string>();
    const Json result =
        view(room() + " --method constant --samples 1 --exposure 0 --object '" + name + "' -o " + path("taken.png"));
    EXPECT_EQ(result.at("objects").at(1).at("name"), name);
    EXPECT_TRUE(bytes_of(plain) == bytes_of(path("taken.png"))) << name;
    break;
  }
}

// Lamps over a floor, as many as there are intensities.
std::string write_lamps(const std::string& name, const std::vector<float>& intensities_cd) {
  GltfBuilder gltf;
  const int indices = gltf.add_indices({0, 1, 2, 0, 2, 3});
  const int positions = gltf.add(std::vector<V3f>{{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}});
  gltf.add_node({{"mesh", gltf.add_mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}})}});
  gltf.use_extension("KHR_lights_punctual");
  nlohmann::json& lights = gltf.root["extensions"]["KHR_lights_punctual"]["lights"];
  for (const float intensity : intensities_cd) {
    const int light = int(lights.size());
    lights.push_back({{"type", "point"}, {"intensity", intensity}});
    gltf.add_node({{"translation", {std::sin(intensity), 1, std::cos(intensity)}},
                   {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
  }
  return gltf.write(name);
}

// Two lamps over a floor in groups of their own: dimmed in the viewer they shine as in a file whose lamps are dimmer,
// straight and by way of the grid.
TEST_F(ViewCommand, GroupsOfLightsAreDimmed) {
  const auto lamps = [](const std::string& name, float red, float blue) {
    GltfBuilder gltf;
    const int indices = gltf.add_indices({0, 1, 2, 0, 2, 3});
    const int positions = gltf.add(std::vector<V3f>{{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}});
    const int wall = gltf.add(std::vector<V3f>{{-3, 0, -2}, {3, 0, -2}, {3, 3, -2}, {-3, 3, -2}});
    for (const int quad : {positions, wall})
      gltf.add_node({{"mesh", gltf.add_mesh({{"attributes", {{"POSITION", quad}}}, {"indices", indices}})}});
    gltf.use_extension("KHR_lights_punctual");
    nlohmann::json& lights = gltf.root["extensions"]["KHR_lights_punctual"]["lights"];
    lights = {{{"type", "point"}, {"intensity", red}, {"color", {1, 0.5, 0.5}}},
              {{"type", "point"}, {"intensity", blue}, {"color", {0.5, 0.5, 1}}}};
    for (int i = 0; i < 2; ++i) {
      gltf.add_node({{"name", i == 0 ? "Red" : "Blue"},
                     {"translation", {i == 0 ? -1 : 1, 1.5, 0}},
                     {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
    }
    return gltf.write(name);
  };
  const std::string bright = lamps("bright", 40, 80);
  const std::string dim = lamps("dim", 10, 0);
  const std::string groups = path("groups.vdb");
  const std::string mixed = path("mixed.vdb");
  run("bake grid " + bright + " --resolution 6,4,6 --photons 100k --groups red=Red --groups blue=Blue -o " + groups);
  run("mix " + groups + " --scale red=0.25 --scale blue=0 -o " + mixed);
  const std::string factors = " --group-scale red=0.25 --group-scale blue=0";
  const Film shown = film(bright + " " + groups + factors);
  // The dim scene with the mixed grid; half floats are rounded where the file's numbers were.
  EXPECT_LT(compare_images(shown, film(dim + " " + mixed)).nrmse, 1e-3);
  EXPECT_GT(compare_images(shown, film(bright + " " + groups)).nrmse, 0.1);
  EXPECT_LT(compare_images(film(bright + " " + groups + factors + " --indirect-only"),
                           film(bright + " " + mixed + " --indirect-only"))
                .nrmse,
            1e-3);
  const RunResult refused =
      run_ivory("view --headless " + bright + " " + groups + " --group-scale green=1 -o " + path("x.png"));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.output.find("red, blue"), std::string::npos) << refused.output;
}

TEST_F(ViewCommand, StrongestOfTooManyLightsShine) {
  std::vector<float> strong;
  for (int i = 0; i < 32; ++i) strong.push_back(float(1 + i % 7) + 0.01F * float(i));
  std::vector<float> all = strong;
  all.insert(all.begin() + 20, 0.5F);
  all.insert(all.begin() + 3, 0.25F);
  const std::string how = " --method none --samples 1 --exposure 0 --shadow-size 64 -o ";
  view(write_lamps("strong", strong) + how + path("strong.exr"));
  view(write_lamps("all", all) + how + path("all.exr"));
  EXPECT_TRUE(read_image(path("strong.exr")).pixels == read_image(path("all.exr")).pixels);
  const RunResult said =
      run_ivory("view --headless --size 160x120 --force --frames 2 " + write_lamps("all", all) + how + path("all.exr"));
  EXPECT_NE(said.output.find("2 of the 34 lights are left out"), std::string::npos) << said.output;
  // 64 layers, six a lamp; said once.
  const std::size_t at = said.output.find("22 of the 32 lights cast no shadow");
  ASSERT_NE(at, std::string::npos) << said.output;
  EXPECT_EQ(said.output.find("cast no shadow", at + 40), std::string::npos) << said.output;
}

}  // namespace
}  // namespace ivory
