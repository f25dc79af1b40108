// What ivory view refuses.
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/gltf_builder.h"
#include "tests/support/view_command.h"
#include "tracer/image/file.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

// Every way in which a file can be bad ends in one line, and nothing is drawn.
class ViewBadFiles : public ViewCommand {
 protected:
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  void expect_refused(const std::string& arguments, int exit_code, const std::string& text) const {
    expect_one_line("view --headless --size 64x48 --samples 1 -q -o " + path("out.png") + " " + arguments, exit_code,
                    text);
    EXPECT_FALSE(fs::exists(path("out.png"))) << arguments;
  }
};

TEST_F(ViewBadFiles, EachGetsItsLine) {
  const std::string g = bytes_of(grid());
  for (const std::size_t length : {std::size_t(0), std::size_t(4), std::size_t(100), g.size() / 2, g.size() - 1})
    expect_refused(room() + " " + write("cut.vdb", g.substr(0, length)), 1, "cut.vdb");
  std::string damaged = g;
  damaged[damaged.size() / 2] = char(damaged[damaged.size() / 2] ^ 0x55);
  expect_refused(room() + " " + write("damaged.vdb", damaged), 1, "damaged.vdb");
  expect_refused(room() + " " + write("foreign.vdb", "This is no grid."), 1, "foreign.vdb");
  expect_refused(room() + " " + write("foreign.json", "{\"a\": 1}"), 1, "foreign.json");
  expect_refused(room() + " " + write("broken.json", "{\"coefficients\": [[1,"), 1, "broken.json");
  expect_refused(room() + " " + write("foreign.exr", g), 1, "foreign.exr");
  expect_refused(room() + " " + write("foreign.glb", g), 1, "foreign.glb");
  expect_refused(room() + " " + path("missing.vdb"), 1, "missing.vdb");
  expect_refused(room() + " " + folder_.string(), 1, "folder");
  expect_refused(path("missing.gltf"), 1, "missing.gltf");
  expect_refused(room() + " --object " + write("cut.glb", bytes_of(scene("knot.glb")).substr(0, 5000)), 1, "cut.glb");
  expect_refused(room() + " --reference " + path("none.exr"), 1, "none.exr");
}

TEST_F(ViewBadFiles, PicturesOfTheWrongSizeAreRefused) {
  Film small{32, 17, std::vector<Rgb>(32 * 17, Rgb(1, 1, 1))};
  write_image(path("small.exr"), small, 0, {}, true);
  expect_refused(room() + " --debug difference --reference " + path("small.exr"), 1, "32 x 17");
  expect_refused(room() + " " + path("small.exr"), 1, "32 x 17");
}

TEST_F(ViewBadFiles, OversizedGridIsRefused) {
  // Longer along x than the largest 3D texture (2048 here, in 2022's Mesa; drivers take 16384 at most).
  GltfBuilder gltf;
  const int indices = gltf.add_indices({0, 1, 2, 0, 2, 3});
  const int positions = gltf.add(std::vector<V3f>{{0, 0, 0}, {0, 0, 1}, {40, 0, 1}, {40, 0, 0}});
  gltf.root["materials"].push_back({{"doubleSided", true}, {"emissiveFactor", {1, 1, 1}}});
  gltf.add_node(
      {{"mesh", gltf.add_mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", 0}})}});
  const std::string thin = gltf.write("view_thin");
  ASSERT_EQ(
      run_ivory("bake grid " + thin + " -o " + path("thin.vdb") + " --resolution 17000,2,2 --photons 1k").exit_code, 0);
  expect_refused(thin + " " + path("thin.vdb"), 1, "thin.vdb");
}

TEST_F(ViewBadFiles, ImpossibleCommandsAreUsageErrors) {
  expect_refused(room() + " --method grid", 2, "method grid");
  expect_refused(room() + " --method fiv", 2, "fiv");
  expect_refused(room() + " --method lobes", 2, "spherical light");
  expect_refused(room() + " --method sideways", 2, "sideways");
  expect_refused(room() + " --method-of knot=none", 2, "knot");
  expect_refused(room() + " " + grid() + " --guard rays", 2, "rays");
  expect_refused(room() + " --method none --debug vertices", 2, "grid");
  expect_refused(room() + " --debug difference", 2, "reference");
  expect_refused(room() + " --camera nobody", 2, "nobody");
  expect_refused(room() + " --path circle:1", 2, "--path");
  expect_refused(room() + " --object nowhere", 2, "nowhere");
  expect_refused(room() + " --object " + scene("knot.glb") + " --path square:1", 2, "square");
  expect_refused(room() + " --constant -1,0,0", 2, "--constant");
  expect_one_line("view --headless " + room(), 2, "-o");
  std::ofstream(path("there.png")) << "x";
  expect_one_line("view --headless " + room() + " -o " + path("there.png"), 1, "there.png");
}

TEST_F(ViewBadFiles, ViewsThatHaveNoNumbersAreUsageErrors) {
  // What a display showed is no light that could be taken away from light.
  const std::string small = room() + " --method constant --samples 1 ";
  view(small + "-o " + path("shown.png"));
  const std::string difference = small + "--debug difference --reference " + path("shown.png");
  expect_one_line("view --headless -q --size 160x120 " + difference + " -o " + path("d.exr"), 2,
                  "give an .exr reference");
  EXPECT_FALSE(fs::exists(path("d.exr")));
  view(difference + " -o " + path("d.png"));
  EXPECT_TRUE(fs::exists(path("d.png")));

  run("bake grid " + room() + " -o " + path("open.vdb") + " --resolution 4 --photons 1k --guard off");
  for (const char* debug : {"kept", "guard"})
    expect_refused(room() + " " + path("open.vdb") + " --debug " + debug, 2, "leak guard");
  // A grid that cannot be read as asked is not passed over for another source.
  run("bake grid " + room() + " -o " + path("sh.vdb") + " --resolution 4 --photons 1k --basis sh9");
  expect_refused(room() + " " + path("sh.vdb") + " --reconstruction paper", 2, "basis vectors");
}

TEST_F(ViewBadFiles, MissingOpenGLOrDisplayIsSaid) {
  setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/dev/null", 1);
  expect_refused(room(), 1, "OpenGL");
  unsetenv("__EGL_VENDOR_LIBRARY_FILENAMES");
  const char* display = getenv("DISPLAY");
  const std::string kept = display == nullptr ? "" : display;
  unsetenv("DISPLAY");
  expect_one_line("view " + room(), 1, "--headless");
  if (display != nullptr) setenv("DISPLAY", kept.c_str(), 1);
}

}  // namespace
}  // namespace ivory
