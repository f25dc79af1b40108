// The runtime for C: the same light as the runtime for C++ gives, and an error for what is wrong.
#include <filesystem>

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include "grid/io/difmap.h"
#include "grid/io/fiv.h"
#include "grid/io/lobes.h"
#include "grid/io/sh9.h"
#include "grid/io/vdb/vdb.h"
#include "runtime/assets/fiv.h"
#include "runtime/assets/lobes.h"
#include "runtime/assets/sh9.h"
#include "runtime/c/ivory.h"
#include "tests/runtime/fiv_synthetic.h"
#include "tests/support/folder_test.h"
#include "tests/support/grid_twin.h"

namespace ivory {

namespace {

class RuntimeC : public GlTest {
 protected:
  void SetUp() override { folder_ = fresh_test_folder(); }

  std::string path(const char* name) const { return (folder_ / name).string(); }

  std::string sh9_file() const {
    Sh9Asset asset;
    asset.sh.coefficients[0] = V3d(900, 800, 1200);
    asset.sh.coefficients[1] = V3d(300, 200, 600);
    write_sh9(path("sky.json"), asset, true);
    return path("sky.json");
  }

  // E at receivers around the origin.
  static std::vector<V4f> read(const std::string& shader, const BindProgram& bind) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> around(-3, 3);
    std::vector<V4f> p;
    std::vector<V4f> n;
    for (int i = 0; i < 500; ++i) {
      p.emplace_back(around(random), around(random), around(random), 0.0F);
      n.push_back(to_v4(random_direction(random)));
    }
    return evaluate_on_gpu(
        shader +
            "vec4 evaluate(int i) { vec3 n = input1(i).xyz; return vec4(ivory_ambient(input0(i).xyz, n, n), 1.0); }",
        {p, n}, bind);
  }
  static std::vector<V4f> read(const ivory_light* light) {
    return read(ivory_shader(light), [&](gl::Program& program) { EXPECT_GE(ivory_bind(light, program.id(), 0), 0); });
  }
  static std::vector<V4f> read(const AmbientSource& source) {
    return read(source.shader, [&](gl::Program& program) { source.bind(program, 0); });
  }

  // It names what is wrong, once.
  static void expect_error(const char* part) {
    const std::string text = ivory_error();
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(RuntimeC, GivesTheLightOfTheAssets) {
  const std::string sky = sh9_file();
  ivory_light* light = ivory_load_sh9(sky.c_str());
  ASSERT_NE(light, nullptr) << ivory_error();
  const GpuSh9 sh9 = load_sh9(sky);
  EXPECT_EQ(read(light), read(ambient(sh9)));

  const FivTable table = synthetic_table(synthetic_sky(3), V3i(8, 5, 3), 6, {0.5F, 1, 4}, 2);
  write_fiv(path("fiv.exr"), table, ExrPrecision::float32, true);
  const std::string fiv_name = path("fiv.exr");
  const char* names[]{fiv_name.c_str()};
  ivory_light* shadowed = ivory_load_fiv(names, 1, light);
  ASSERT_NE(shadowed, nullptr) << ivory_error();
  ivory_free(light);  // the tables keep what they need of it
  EXPECT_EQ(read(shadowed), read(ambient(sh9))) << "no occluder stands anywhere yet";
  const ivory_occluder occluders[]{{0, {1, 0, 0}, 0.5F, 0}, {0, {-1, 1, 0.5F}, 1, 0}};
  EXPECT_EQ(ivory_set_occluders(shadowed, occluders, 2), 0) << ivory_error();
  GpuFivTables fiv = load_fiv_tables(std::vector<std::string>{fiv_name});
  set_occluders(fiv, std::vector<GpuFivOccluder>{{0, V3f(1, 0, 0), 0.5F}, {0, V3f(-1, 1, 0.5F), 1}});
  const std::vector<V4f> hidden = read(ambient(fiv, sh9));
  EXPECT_NE(hidden, read(ambient(sh9)));
  EXPECT_EQ(read(shadowed), hidden);

  // One table each: they may go round with the environment, not against it.
  EXPECT_EQ(ivory_turn_environment(shadowed, 40), -1);
  EXPECT_NE(std::string(ivory_error()).find("--turns"), std::string::npos) << ivory_error();
  EXPECT_EQ(read(shadowed), hidden);
  EXPECT_EQ(ivory_set_occluders(shadowed, nullptr, 0), 0);
  EXPECT_EQ(ivory_turn_environment(shadowed, 40), 0) << ivory_error();
  const ivory_occluder turning[]{{0, {1, 0, 0}, 0.5F, 40}};
  EXPECT_EQ(ivory_set_occluders(shadowed, turning, 1), 0) << ivory_error();
  const float turn_rad = 40 * (pi / 180);
  set_occluders(fiv, std::vector<GpuFivOccluder>{{0, V3f(1, 0, 0), 0.5F, turn_rad}}, turn_rad);
  GpuSh9 turned = sh9;
  turned.turn_rad = turn_rad;
  EXPECT_EQ(read(shadowed), read(ambient(fiv, turned)));

  const ivory_occluder foreign{1, {0, 0, 0}, 1, 0};
  EXPECT_EQ(ivory_set_occluders(shadowed, &foreign, 1), -1);
  expect_error("occluders");
  ivory_free(shadowed);

  write_lobes(path("lobes.exr"), make_lobe_table({5, 5}), {{"method", std::string("moments")}}, true);
  ivory_light* lobes = ivory_load_lobes(path("lobes.exr").c_str());
  ASSERT_NE(lobes, nullptr) << ivory_error();
  const ivory_sphere_light lamp{{{0, 5, 0}, 0.5F}, {100, 200, 300}};
  const ivory_sphere ball{{0, 1, 0}, 0.7F};
  EXPECT_EQ(ivory_set_spheres(lobes, &lamp, 1, &ball, 1), 0) << ivory_error();
  GpuLobes same = load_lobes(path("lobes.exr"));
  place(same, std::vector<RuntimeSphereLight>{{{V3f(0, 5, 0), 0.5F}, Rgb(100, 200, 300)}},
        std::vector<Sphere>{{V3f(0, 1, 0), 0.7F}});
  EXPECT_EQ(read(lobes), read(ambient(same, false)));
  ivory_free(lobes);
}

// A grid tells where it lies; sums outlive what they are made of.
TEST_F(RuntimeC, AddsLightUp) {
  IrradianceGrid grid = random_grid(V3i(5, 4, 6), Basis::sh4, true, true, 9);
  grid.frame.origin_m = V3f(-2, -1, 1);
  write_vdb(path("grid.vdb"), grid, true);
  ivory_light* room = ivory_load_grid(path("grid.vdb").c_str());
  ASSERT_NE(room, nullptr) << ivory_error();
  float least[3];
  float greatest[3];
  double anchor[3];
  ASSERT_EQ(ivory_bounds(room, least, greatest), 0) << ivory_error();
  ASSERT_EQ(ivory_anchor(room, anchor), 0) << ivory_error();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT(least[axis], greatest[axis]);
    EXPECT_EQ(anchor[axis], 0);
  }
  ivory_light* sky = ivory_load_sh9(sh9_file().c_str());
  ASSERT_NE(sky, nullptr) << ivory_error();
  const std::vector<V4f> of_room = read(room);
  const std::vector<V4f> of_sky = read(sky);
  const ivory_light* parts[]{room, sky, sky};
  const float weights[][3]{{1, 1, 1}, {0.5F, 0.25F, 1}, {0, 0, 2}};
  ivory_light* sum = ivory_sum(parts, weights, 3);
  ASSERT_NE(sum, nullptr) << ivory_error();
  EXPECT_EQ(ivory_bounds(sum, least, greatest), -1);
  expect_error("another kind");
  ivory_free(room);
  ivory_free(sky);
  const std::vector<V4f> together = read(sum);
  for (std::size_t i = 0; i < together.size(); ++i) {
    for (unsigned c = 0; c < 3; ++c) {
      const float expected = of_room[i][c] + of_sky[i][c] * (c == 0 ? 0.5F : c == 1 ? 0.25F : 3.0F);
      // A few roundings of float, 6e-8 each, of sums of some ten terms.
      EXPECT_NEAR(together[i][c], expected, 1e-5F * std::abs(expected) + 1e-3F);
    }
  }
  ivory_free(sum);
}

TEST_F(RuntimeC, SaysWhatIsWrong) {
  const int objects = live_gl_objects();
  EXPECT_EQ(ivory_load_grid(path("none.vdb").c_str()), nullptr);
  expect_error("none.vdb");
  EXPECT_EQ(ivory_load_grid(sh9_file().c_str()), nullptr);
  expect_error("sky.json");
  EXPECT_EQ(ivory_load_sh9(nullptr), nullptr);
  expect_error("NULL");
  ivory_light* sky = ivory_load_sh9(sh9_file().c_str());
  ASSERT_NE(sky, nullptr);
  EXPECT_EQ(ivory_set_occluders(sky, nullptr, 0), -1);
  expect_error("another kind");
  EXPECT_EQ(ivory_set_spheres(nullptr, nullptr, 0, nullptr, 0), -1);
  expect_error("NULL");
  const char* none[]{"none.exr"};
  EXPECT_EQ(ivory_load_fiv(none, 1, nullptr), nullptr);
  expect_error("environment");
  EXPECT_EQ(ivory_load_fiv(none, 1, sky), nullptr);
  expect_error("none.exr");
  EXPECT_EQ(ivory_bind(nullptr, 0, 0), -1);
  ivory_free(sky);
  ivory_free(nullptr);
  EXPECT_EQ(live_gl_objects(), objects);
}

}  // namespace

}  // namespace ivory
