// Pages: what is copied into them, and that Chromium shows what ivory render shows.
#include <algorithm>
#include <cmath>
#include <fstream>

#include "tests/support/command_test.h"
#include "tests/tools/export/node_reader.h"
#include "tracer/image/file.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

bool has_chromium() { return std::system("command -v chromium >/dev/null 2>&1") == 0; }

class ExportWeb : public CommandTest {
 protected:
  void bake(const std::string& scene_file, const std::string& options) const {
    run("bake grid " + scene_file + " -o " + path("g.vdb") + " --force " + options);
  }
  Json export_page(const std::string& scene_file, const std::string& three, const std::string& more = {}) const {
    return run("export " + scene_file + " --grid " + path("g.vdb") + " --to web -o " + path("page") + "/ --three " +
               three + " " + more);
  }
  // What stands for three.js where nothing runs it: the modules that a page names, and one that another imports.
  std::string make_package(const std::string& version, bool with_grid) const {
    const std::string folder = path("three-" + version);
    const auto write = [&](const std::string& name, const std::string& text) {
      fs::create_directories(fs::path(folder + "/" + name).parent_path());
      std::ofstream(folder + "/" + name) << text;
    };
    write("package.json", R"({"name": "three", "version": ")" + version + "\"}");
    write("LICENSE", "MIT");
    write("build/three.module.js", "export * from './three.core.js';");
    write("build/three.core.js", "export const a = 1;");
    write("build/three.webgpu.js", "export const b = 1;");
    for (const char* name : {"controls/OrbitControls.js", "loaders/GLTFLoader.js"})
      write(std::string("examples/jsm/") + name, "import { a } from 'three';");
    write("examples/jsm/loaders/KTX2Loader.js", "import { W }\n from '../utils/WorkerPool.js';");
    write("examples/jsm/utils/WorkerPool.js", "export const W = 1;");
    if (with_grid) write("examples/jsm/lighting/LightProbeGridWebGL.js", "import '../utils/WorkerPool.js';");
    return folder;
  }
  std::vector<std::string> files(const std::string& folder) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(path(folder)))
      if (entry.is_regular_file()) names.push_back(fs::relative(entry.path(), path(folder)).generic_string());
    std::sort(names.begin(), names.end());
    return names;
  }
};

TEST_F(ExportWeb, HoldsAllThatItNeeds) {
  bake(scene("room_boxes.gltf"), "--resolution 4 --photons 20k");
  const std::string three = make_package("0.187.0", true);
  run("bake sh9 " + scene("sky.hdr") + " -o " + path("sky.json"));
  const Json result = export_page(scene("room_boxes.gltf"), three, "--sh9 " + path("sky.json"));
  EXPECT_EQ(files("page"),
            (std::vector<std::string>{
                "controls.js", "errors.bin", "index.html", "lamps.js", "light.js", "light.json", "light.ktx2",
                "page.css", "page.js", "page.json", "scene.glb", "three/LICENSE", "three/build/three.core.js",
                "three/build/three.module.js", "three/examples/jsm/controls/OrbitControls.js",
                "three/examples/jsm/lighting/LightProbeGridWebGL.js", "three/examples/jsm/loaders/GLTFLoader.js",
                "three/examples/jsm/loaders/KTX2Loader.js", "three/examples/jsm/utils/WorkerPool.js"}));
  EXPECT_EQ(result["three"], "0.187.0");
  EXPECT_EQ(result["thin_walls"].get<int>() > 0, !result["report"]["thin_walls"].empty());
  const Json page = Json::parse(bytes_of(path("page/page.json")), nullptr, false);
  EXPECT_EQ(page["views"][0]["name"], "corner");
  EXPECT_NEAR(page["views"][0]["position"][0].get<double>(), -2.3, 1e-5);
  EXPECT_EQ(page["stored"], Json::parse(R"({"punctual": false, "area": false, "sky": false})"));
  EXPECT_EQ(page["sky"].size(), 27U);
  EXPECT_EQ(page["lamps"], Json::parse(R"([{"node": 1, "group": ""}])"));
  EXPECT_EQ(bytes_of(path("page/errors.bin")).size(), 10U * page["errors"]["count"].get<std::size_t>());
  // Nothing of the page asks for another server.
  for (const char* name : {"index.html", "page.js", "controls.js", "lamps.js", "page.css", "light.js", "page.json"})
    EXPECT_EQ(bytes_of(path(std::string("page/") + name)).find("://"), std::string::npos) << name;
  // The same bytes again, into the folder that is there; what is not the page's stays.
  const std::string before = bytes_of(path("page/errors.bin")) + bytes_of(path("page/page.json"));
  std::ofstream(path("page/mine.txt")) << "mine";
  export_page(scene("room_boxes.gltf"), three, "--force --threads 1 --sh9 " + path("sky.json"));
  EXPECT_EQ(bytes_of(path("page/errors.bin")) + bytes_of(path("page/page.json")), before);
  EXPECT_EQ(bytes_of(path("page/mine.txt")), "mine");
}

TEST_F(ExportWeb, SaysWhatIsMissing) {
  bake(scene("room_boxes.gltf"), "--resolution 4 --photons 20k");
  const std::string three = make_package("0.187.0", true);
  const std::string command = "export " + scene("room_boxes.gltf") + " --to web -o " + path("p");
  const std::string grid = " --grid " + path("g.vdb");
  expect_one_line(command + " --three " + three, 2, "--grid");
  expect_one_line(command + grid + " --three " + path("none"), 1, "npm install three");
  expect_one_line(command + grid + " --three " + make_package("0.160.0", false), 1, "0.160.0");
  expect_one_line("export " + path("g.vdb") + " --to web -o " + path("p"), 2, "SCENE --grid");
  expect_one_line(command + ".html" + grid + " --three " + three, 2, "folder");
  expect_one_line("export " + scene("room_boxes.gltf") + " --to three.js -o " + path("p.ktx2"), 1, "not baked");
  expect_one_line("export " + path("g.vdb") + " --to sides" + grid + " -o " + path("p.ktx2"), 2, "--grid");
  fs::create_directories(path("full"));
  std::ofstream(path("full/file")) << "mine";
  expect_one_line("export " + scene("room_boxes.gltf") + " --to web -o " + path("full") + grid + " --three " + three, 1,
                  "--force");
  // Nothing is left behind.
  EXPECT_EQ(files("full").size(), 1U);
  EXPECT_FALSE(fs::exists(path("p")));
  for (const auto& entry : fs::directory_iterator(path(".")))
    EXPECT_FALSE(entry.path().filename().string().starts_with("."));
}

#define SKIP_WITHOUT_A_BROWSER() \
  SKIP_WITHOUT_NODE_PACKAGES();  \
  if (!has_chromium()) GTEST_SKIP() << "chromium is not installed (CONTRIBUTING.md)"

constexpr int width = 96;
constexpr int height = 64;

struct Difference {
  double median = 0;  // of the pixels' relative differences
  double mean = 0;    // of the pictures' means
};
// `values` as Page.radiance() answers them.
Difference difference(const Json& values, const Film& film) {
  Difference out;
  std::vector<double> relative;
  double sums[2] = {0, 0};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double shown = values[std::size_t(4 * ((height - 1 - y) * width + x))];
      const double known = film.at(x, y).x;
      sums[0] += shown;
      sums[1] += known;
      relative.push_back(std::abs(shown / known - 1));
    }
  }
  std::nth_element(relative.begin(), relative.begin() + std::ptrdiff_t(relative.size() / 2), relative.end());
  out.median = relative[relative.size() / 2];
  out.mean = sums[0] / sums[1] - 1;
  return out;
}

// What is drawn is what ivory render draws by the same grid: light through the atlas, lamps with shadows, the camera.
TEST_F(ExportWeb, ChromiumShowsWhatIvoryRenders) {
  SKIP_WITHOUT_A_BROWSER();
  bake(scene("room_boxes.gltf"), "--resolution 12 --photons 200k --groups hall=lamp");
  export_page(scene("room_boxes.gltf"), std::string(std::getenv("IVORY_NODE_MODULES")) + "/three");
  const Json read = run_reader(
      "page.mjs", path("page") +
                      " 'page.mode = \"split\"; page.drawNow();"
                      "const all = [page.radiance(0, 96, 64, {lamps: false}), page.radiance(0, 96, 64, {on: false}),"
                      " page.radiance(0, 96, 64)]; await page.setLights(\"hall\", 0.5);"
                      "all.push(page.radiance(0, 96, 64)); document.getElementById(\"errors\").click();"
                      "await new Promise((r) => setTimeout(r, 500)); return all;' " +
                      path("page.png"));
  ASSERT_FALSE(read.is_discarded());
  EXPECT_EQ(read["complaints"], Json::array()) << read["complaints"];
  std::printf("first frame after %.0f ms\n", read["firstFrameMs"].get<double>());
  const auto render = [&](const std::string& name, const std::string& options) {
    run("render " + scene("room_boxes.gltf") + " --size 96x64 -o " + path(name) + " " + options);
    return read_image(path(name));
  };
  const std::string by_grid = "--method direct --guard planes --samples 4 --grid " + path("g.vdb");
  const Difference indirect = difference(read["answer"][0], render("indirect.exr", by_grid + " --indirect-only"));
  const Difference direct = difference(read["answer"][1], render("direct.exr", "--max-bounces 1 --samples 16"));
  const Difference both = difference(read["answer"][2], render("both.exr", by_grid));
  std::printf("median and of means: indirect %.2f %% %+.2f %%, direct %.2f %% %+.2f %%, both %.2f %% %+.2f %%\n",
              100 * indirect.median, 100 * indirect.mean, 100 * direct.median, 100 * direct.mean, 100 * both.median,
              100 * both.mean);
  // Its own half cell off the surface, edges of shadows, and one sample a pixel where ivory takes several: found 0.3 %
  // and 0.1 %. A share of pi, of albedo or of Fresnel's reflectance (4 %) would show.
  for (const Difference& d : {indirect, direct, both}) {
    EXPECT_LT(d.median, 0.01);
    EXPECT_LT(std::abs(d.mean), 0.01);
  }
  // The one lamp's group, dimmed by half: its own light and the baked.
  for (std::size_t i = 0; i < std::size_t(4 * width * height); i += 4)
    ASSERT_NEAR(read["answer"][3][i].get<double>(), 0.5 * read["answer"][2][i].get<double>(), 2e-3);  // half floats
}

}  // namespace
}  // namespace ivory
