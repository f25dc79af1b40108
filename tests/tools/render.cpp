// ivory render and ivory compare as a script meets them.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command_test.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

class RenderCommand : public CommandTest {};

int line_count(const std::string& text) { return int(std::count(text.begin(), text.end(), '\n')); }

TEST_F(RenderCommand, FurnaceIsFlatByEveryMethod) {
  const std::string furnace = scene("furnace_box.gltf");
  const RunResult bake =
      run_ivory("bake grid " + furnace + " -o " + path("f.vdb") + " --resolution 4 --photons 1m --threads 2");
  ASSERT_EQ(bake.exit_code, 0) << bake.output;
  struct Case {
    const char* options;
    double mean;       // nits
    double tolerance;  // four standard errors of the picture's mean, measured, rounded up
  };
  // L_e = 1, albedo 1/2: L = 2, of which rho^2/(1-rho) = 0.5 is indirect.
  for (const Case& c : {Case{"--method path", 2, 0.01}, Case{"--method path --indirect-only", 0.5, 0.01},
                        Case{"--method direct --grid ", 2, 0.01}, Case{"--method gather --gather 4 --grid ", 2, 0.01},
                        Case{"--method gather --indirect-only --grid ", 0.5, 0.01},
                        // Discs that reach over the walls' edges are too dark there: a band of a disc's 3 cm along
                        // 1 m of wall loses a fifth of its indirect half nit at most.
                        Case{"--method photonmap --photons 200k --neighbours 20", 2, 0.03},
                        Case{"--method photonmap --photons 200k --gather 4 --indirect-only", 0.5, 0.02}}) {
    std::string options = c.options;
    if (options.back() == ' ') options += path("f.vdb");
    const RunResult run = run_ivory("render " + furnace + " -o " + path("f.exr") +
                                        " --force --json --quiet --size 64x48 " + "--samples 16 --threads 2 " + options,
                                    false);
    ASSERT_EQ(run.exit_code, 0) << options;
    const auto result = nlohmann::json::parse(run.output);
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(result.at("mean_radiance_nits").at(std::size_t(channel)).get<double>(), c.mean, c.tolerance)
          << options;
  }
}

TEST_F(RenderCommand, SameBytesOnAnyNumberOfThreads) {
  const std::string room = scene("cornell_box.gltf");
  for (const char* extension : {"exr", "png"}) {
    const std::string one = path(std::string("one.") + extension);
    const std::string two = path(std::string("two.") + extension);
    for (const char* method : {"path", "photonmap --photons 10k"}) {
      const std::string command = "render " + room + " --size 40x30 --samples 4 --force --method " + method;
      ASSERT_EQ(run_ivory(command + " --threads 1 -o " + one).exit_code, 0);
      ASSERT_EQ(run_ivory(command + " --threads 2 -o " + two).exit_code, 0);
      EXPECT_EQ(bytes_of(one), bytes_of(two));
      EXPECT_FALSE(bytes_of(one).empty());
    }
  }
}

TEST_F(RenderCommand, CompareMeasuresNoise) {
  const std::string room = scene("cornell_box.gltf");
  ASSERT_EQ(run_ivory("render " + room + " --size 40x30 --samples 4 -o " + path("a.exr")).exit_code, 0);
  ASSERT_EQ(run_ivory("render " + room + " --size 40x30 --samples 4 --seed 2 -o " + path("b.exr")).exit_code, 0);
  const auto same = nlohmann::json::parse(run_ivory("compare --json " + path("a.exr") + " " + path("a.exr")).output);
  EXPECT_EQ(same.at("nrmse"), 0.0);
  EXPECT_EQ(same.at("max"), 0.0);
  const auto other = nlohmann::json::parse(run_ivory("compare --json " + path("a.exr") + " " + path("b.exr")).output);
  EXPECT_GT(other.at("nrmse"), 0.0);
  EXPECT_LT(other.at("nrmse"), 0.2);
}

// Each ends in one line and the right exit code, and leaves no file.
TEST_F(RenderCommand, BadRequestsEndInOneLine) {
  const std::string room = scene("cornell_box.gltf");
  const std::string out = " -o " + path("x.exr");
  ASSERT_EQ(run_ivory("render " + room + " --size 8x8 --samples 1 -o " + path("there.exr")).exit_code, 0);
  ASSERT_EQ(run_ivory("render " + room + " --size 9x8 --samples 1 -o " + path("other.exr")).exit_code, 0);
  std::ofstream(path("bad.vdb")) << "nonsense";
  struct Case {
    std::string arguments;
    int exit_code;
  };
  for (const Case& c : {
           Case{"render " + room + out + " --method direct", 2},
           Case{"render " + room + out + " --method nonsense", 2},
           Case{"render " + room + out + " --samples 0", 2},
           // Found before the scene is read.
           Case{"render " + path("missing.gltf") + out + " --samples 0", 2},
           Case{"render " + path("missing.gltf") + out + " --method lobes --indirect-only", 2},
           Case{"render " + path("missing.gltf") + out + " --method fiv --indirect-only --env " + path("no.hdr"), 2},
           Case{"render " + room + out + " --method photonmap --neighbours 1", 2},
           Case{"render " + room + out + " --method photonmap --photons 0", 2},
           Case{"render " + room + out + " --method photonmap --photons 4000g", 1},
           Case{"render " + room + out + " --size 0x5", 2},
           Case{"render " + room + out + " --camera nobody", 2},
           Case{"render " + room, 2},
           Case{"render " + room + out + " --method direct --grid " + path("missing.vdb"), 1},
           Case{"render " + room + out + " --method direct --grid " + path("bad.vdb"), 1},
           Case{"render " + room + out + " --env " + path("missing.hdr"), 1},
           Case{"render " + path("missing.gltf") + out, 1},
           Case{"render " + room + " -o " + path("there.exr"), 1},
           Case{"render " + room + out + out, 2},
           Case{"render " + room + out + " -o " + path("./x.exr"), 2},
           Case{"render " + room + " -o " + path("x.nonsense") + " --size 4096x4096 --samples 1000", 1},

           Case{"compare " + path("there.exr") + " " + path("other.exr"), 1},
           Case{"compare " + path("there.exr") + " " + path("missing.exr"), 1},
       }) {
    const RunResult run = run_ivory(c.arguments);
    EXPECT_EQ(run.exit_code, c.exit_code) << c.arguments << "\n" << run.output;
    EXPECT_EQ(line_count(run.output), 1) << c.arguments << "\n" << run.output;
    EXPECT_FALSE(fs::exists(path("x.exr"))) << c.arguments;
  }
}

TEST_F(RenderCommand, StoresCameraAndBallsOfLight) {
  const nlohmann::json result =
      run("render " + scene("cornell_box.gltf") + " --size 8x8 --samples 1 --camera 0 -o " + path("a.exr") +
          " --sphere-light 0,0.5,0,0.1,1,2,3 --sphere-light 0,0.6,0,0.1,1,2,3");
  EXPECT_EQ(result.at("camera"), "0");
  EXPECT_EQ(result.at("sphere_lights"), "0,0.5,0,0.1,1,2,3 0,0.6,0,0.1,1,2,3");
}

TEST_F(RenderCommand, SaysWhatItIgnores) {
  const std::string command = "render " + scene("cornell_box.gltf") + " --size 8x8 --samples 1 -o " + path("a.exr") +
                              " --gather 4 --exposure 1";
  const RunResult run = run_ivory(command);
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_NE(run.output.find("--gather is ignored"), std::string::npos) << run.output;
  EXPECT_NE(run.output.find("--exposure is ignored"), std::string::npos) << run.output;
  EXPECT_EQ(run_ivory(command + " --force --quiet").output, "");
}

// A grid of the far room alone has no light for the near one, nor any vertex that sees into it.
TEST_F(RenderCommand, SaysWhereTheGridHasNoLight) {
  const std::string rooms = scene("two_rooms.gltf");
  const auto warnings = [&](const std::string& bounds) {
    run("bake grid " + rooms + " -o " + path("g.vdb") + " --resolution 8 --photons 10k --force" + bounds);
    const RunResult drawn = run_ivory("render " + rooms + " --method direct --grid " + path("g.vdb") + " -o " +
                                          path("a.exr") + " --size 32x24 --samples 1 --json --quiet --force",
                                      false);
    const auto result = nlohmann::json::parse(drawn.output);
    EXPECT_EQ(result.contains("grid_unseen_share"), !bounds.empty());
    EXPECT_EQ(result.contains("grid_outside_share"), !bounds.empty());
    return result.at("warnings").dump();
  };
  EXPECT_EQ(warnings(""), "[]");
  const std::string far = warnings(" --bounds=-2,0,4:2,3,8");
  EXPECT_NE(far.find("no vertex sees"), std::string::npos) << far;
  EXPECT_NE(far.find("outside the grid"), std::string::npos) << far;
}

// A sky is a light like any other: indirect light of one under another is wrong everywhere.
TEST_F(RenderCommand, RefusesAssetsOfOtherEnvironments) {
  const std::string furnace = scene("furnace_box.gltf");
  for (const char* name : {"one.hdr", "two.hdr"}) {
    std::ofstream file(path(name), std::ios::binary);
    file << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n";
    for (int i = 0; i < 32; ++i) file << char(128) << char(128) << char(name[0]) << char(129);
  }
  const std::string one = " --env " + path("one.hdr");
  const std::string two = " --env " + path("two.hdr");
  run("bake grid " + furnace + one + " -o " + path("lit.vdb") + " --resolution 3 --photons 10k");
  run("bake grid " + furnace + " -o " + path("bare.vdb") + " --resolution 3 --photons 10k");
  const std::string render = "render " + furnace + " -q --size 8x8 --samples 1 -o " + path("x.exr") + " --method ";
  const std::string lit = "direct --grid " + path("lit.vdb");
  const std::string bare = "direct --grid " + path("bare.vdb");
  expect_one_line(render + lit + two, 1, "another environment (one.hdr)");
  expect_one_line(render + lit, 1, "--env");
  expect_one_line(render + bare + one, 1, "without an environment");
  run(render + lit + one + " --force");
  run(render + bare + " --force");

  run("bake cubemap " + furnace + one + " --at 0,0,0 --capture 16 --samples 1 --grid " + path("lit.vdb") + " -o " +
      path("lit.exr"));
  expect_one_line("bake cubemap " + furnace + two + " --at 0,0,0 -q --grid " + path("lit.vdb") + " -o " + path("y.exr"),
                  1, "another environment");
  const std::string cubemap = "render " + furnace + " -q --size 8x8 --samples 1 -o " + path("z.exr") +
                              " --method cubemap --object " + scene("knot.glb") + " --cubemap " + path("lit.exr");
  expect_one_line(cubemap + two, 1, "another environment");
  expect_one_line(cubemap, 1, "--env");
  run(cubemap + one);
}

TEST_F(RenderCommand, RefusesAGridWithDirectLight) {
  const std::string furnace = scene("furnace_box.gltf");
  ASSERT_EQ(
      run_ivory("bake grid " + furnace + " --direct -o " + path("d.vdb") + " --resolution 3 --photons 10k").exit_code,
      0);
  const RunResult run =
      run_ivory("render " + furnace + " -o " + path("x.exr") + " --method direct --grid " + path("d.vdb"));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.output.find("direct light"), std::string::npos);
}

}  // namespace
}  // namespace ivory
