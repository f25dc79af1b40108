// The shaders of ambient/ in the other languages that the build translates them into: they compile, and read the same
// light as the GLSL that they come from.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>

#include "runtime/assets/cubemap.h"
#include "runtime/assets/difmap.h"
#include "runtime/assets/fiv.h"
#include "runtime/assets/lobes.h"
#include "runtime/assets/sh9.h"
#include "tests/runtime/fiv_synthetic.h"
#include "tests/support/grid_twin.h"
#include "tests/support/paths.h"

namespace ivory {

namespace {

namespace fs = std::filesystem;

fs::path translations() { return fs::path(build_folder) / "runtime/translations"; }

bool succeeds(const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()) == 0; }

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// A translated shader with its entry point as a function that reads and writes globals.
std::string as_functions(std::string text) {
  text = std::regex_replace(text, std::regex("#version[^\n]*\n"), "");
  text =
      std::regex_replace(text, std::regex("(layout\\(location = \\d+\\) )?\\b(in|out) ((highp )?vec\\d \\w+;)"), "$3");
  text = std::regex_replace(text, std::regex("void main\\(\\)"), "void entry()");
  return text + R"(
vec4 evaluate(int i) {
  ivory_in_position = input0(i).xyz;
  ivory_in_geometric_normal = input1(i).xyz;
  ivory_in_shading_normal = input1(i).xyz;
  entry();
  return ivory_out_irradiance;
})";
}

class RuntimeTranslations : public GlTest {
 protected:
  void SetUp() override {
    if (!fs::exists(translations() / "done")) GTEST_SKIP() << "needs glslangValidator and spirv-cross when configured";
  }

  // E at 2,000 receivers around the origin by the GLSL of the library, and by each translation that OpenGL takes: the
  // GLSL ES, and what the SPIR-V says, turned back into GLSL 3.30.
  static void expect_same(const std::string& kind, const BindProgram& bind) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> around(-3, 3);
    std::vector<V4f> p;
    std::vector<V4f> n;
    for (int i = 0; i < 2000; ++i) {
      p.emplace_back(around(random), around(random), around(random), 0.0F);
      n.push_back(to_v4(random_direction(random)));
    }
    const std::vector<V4f> expected = evaluate_on_gpu("#include \"ambient/" + kind +
                                                          ".glsl\"\nvec4 evaluate(int i) { vec3 n = input1(i).xyz; "
                                                          "return vec4(ivory_ambient(input0(i).xyz, n, n), 1.0); }",
                                                      {p, n}, bind);
    double mean = 0;
    for (const V4f& e : expected) mean += double(e.x + e.y + e.z) / 3 / double(expected.size());
    ASSERT_GT(mean, 0) << kind;

    std::vector<fs::path> sources;
    const fs::path again = fs::path(output_folder) / ("translated_" + kind + ".glsl");
    fs::create_directories(output_folder);
    const std::string spirv = (translations() / (kind + ".spv")).string();
    ASSERT_TRUE(succeeds("spirv-cross " + spirv + " --version 330 --no-420pack-extension --output " + again.string()));
    sources.push_back(again);
    const fs::path es = translations() / (kind + ".es.glsl");
    if (fs::exists(es)) sources.push_back(es);
    for (const fs::path& source : sources) {
      const std::vector<V4f> result = evaluate_on_gpu(as_functions(text_of(source)), {p, n}, bind);
      int differ = 0;
      for (std::size_t i = 0; i < result.size(); ++i) {
        for (unsigned c = 0; c < 3; ++c) {
          // The same sums, which compilers may order and contract otherwise: a few roundings of 6e-8 of terms that
          // may be hundreds of times what is left of them.
          if (!(std::abs(result[i][c] - expected[i][c]) <= 1e-4 * (std::abs(double(expected[i][c])) + mean))) ++differ;
        }
      }
      // What rounding decides (which vertex sees, which shadow is stronger) is one in a thousand at most.
      EXPECT_LE(differ, 6) << source;
    }
  }
};

TEST_F(RuntimeTranslations, CompileEverywhere) {
  int compiled = 0;
  for (const auto& entry : fs::directory_iterator(translations())) {
    const std::string path = entry.path().string();
    if (path.ends_with(".hlsl")) {
      EXPECT_TRUE(succeeds("glslangValidator -D -V -e main -S frag -o /dev/null " + path)) << path;
    } else if (path.ends_with(".es.glsl")) {
      EXPECT_TRUE(succeeds("glslangValidator -S frag " + path)) << path;
    } else {
      continue;
    }
    ++compiled;
  }
  EXPECT_EQ(compiled, 7 + 5);  // constant, difmap, fiv, grid and sh9 need no buffer textures
}

TEST_F(RuntimeTranslations, ReadSh9) {
  Sh9 sh;
  sh.coefficients[0] = V3d(90, 80, 120);
  sh.coefficients[1] = V3d(30, 20, 60);
  sh.coefficients[8] = V3d(10, -20, 5);
  const GpuSh9 gpu = upload(sh);
  expect_same("sh9", [&](gl::Program& program) { bind(gpu, program, 0); });
}

TEST_F(RuntimeTranslations, ReadDifMaps) {
  DifMap map;
  map.e.size = 8;
  for (int i = 0; i < 6 * 8 * 8; ++i) map.e.texels.emplace_back(float(i % 7), 1 + float(i % 11), float(i % 3));
  const GpuDifMap gpu = upload(map);
  expect_same("difmap", [&](gl::Program& program) { bind(gpu, program, 0); });
}

TEST_F(RuntimeTranslations, ReadGrids) {
  IrradianceGrid grid = random_grid(V3i(5, 4, 6), Basis::vectors, true, true, 9);
  grid.frame.origin_m = V3f(-2, -1, 1);
  const GpuGrid gpu = upload(grid);
  expect_same("grid", [&](gl::Program& program) { bind(gpu, program, 0, LookupParams{.guard = Guard::planes}); });
}

TEST_F(RuntimeTranslations, ReadCubeMaps) {
  LocalizedCube cube;
  cube.radiance.size = 2;
  for (int i = 0; i < 24; ++i) cube.radiance.texels.emplace_back(float(1 + i % 5), 2.0F, float(i % 3));
  cube.corners.assign(24, TexelCorners{2.5F, 2.5F, 2.5F, 2.5F});
  const GpuLocalizedCube gpu = upload(cube);
  expect_same("cubemap", [&](gl::Program& program) { bind(gpu, program, 0); });
}

TEST_F(RuntimeTranslations, ReadOccluders) {
  const SyntheticSky sky = synthetic_sky(3);
  const FivTable table = synthetic_table(sky, V3i(8, 5, 3), 6, {0.5F, 1, 4}, 2);
  GpuFivTables gpu = upload(std::span(&table, 1));
  const GpuFivOccluder occluders[]{{0, V3f(1, 0, 0), 0.5F}, {0, V3f(-1, 1, 0.5F), 1}};
  set_occluders(gpu, occluders);
  Sh9 sh;
  sh.coefficients[0] = V3d(900, 800, 1200);
  const GpuSh9 unshadowed = upload(sh);
  expect_same("fiv", [&](gl::Program& program) { bind(gpu, unshadowed, program, 0); });
}

TEST_F(RuntimeTranslations, ReadLobes) {
  GpuLobes gpu = upload(make_lobe_table({5, 5}));
  const RuntimeSphereLight lights[]{{{V3f(0, 5, 0), 0.5F}, Rgb(100, 200, 300)}};
  const Sphere occluders[]{{V3f(0, 1, 0), 0.7F}};
  place(gpu, lights, occluders);
  expect_same("lobes", [&](gl::Program& program) { bind(gpu, program, 0); });
}

}  // namespace

}  // namespace ivory
