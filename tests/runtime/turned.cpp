// Environments and occluders that turn, in GLSL against C++.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/base/placement.h"
#include "runtime/assets/fiv.h"
#include "tests/runtime/fiv_synthetic.h"
#include "tests/support/runtime_twin.h"

namespace ivory {
namespace {

class RuntimeTurned : public GlTest {
 protected:
  static std::vector<V4f> normals() {
    std::mt19937 random(4);
    std::vector<V4f> out;
    while (out.size() < 5000) out.push_back(to_v4(random_direction(random)));
    return out;
  }
};

TEST_F(RuntimeTurned, EnvironmentsAreReadByNormalsTurnedBack) {
  const DifMap map = synthetic_difmap(synthetic_sky(2), 32);
  GpuDifMap gpu_map = upload(map);
  Sh9 sh;
  for (std::size_t i = 0; i < 9; ++i) sh.coefficients[i] = V3d(100, 80, 60) / double(1 + i) * (i % 2 == 0 ? 1 : -1);
  sh.coefficients[0] *= 4;
  GpuSh9 gpu_sh = upload(sh);
  const std::vector<V4f> n = normals();
  for (const float turn_rad : {0.0F, 1.1F, -2.7F, 7.0F}) {
    gpu_map.turn_rad = gpu_sh.turn_rad = turn_rad;
    const M33f back = turn_about_y(-double(turn_rad));
    const auto read = [&](const char* file, const auto& asset) {
      return evaluate_on_gpu(
          fmt::format("#include \"ambient/{}\"\nvec4 evaluate(int i) {{ return vec4(ivory_ambient(vec3(7.0), "
                      "input0(i).xyz, input0(i).xyz), 1.0); }}",
                      file),
          {n}, [&](gl::Program& program) { bind(asset, program, 0); });
    };
    const std::vector<V4f> by_map = read("difmap.glsl", gpu_map);
    const std::vector<V4f> by_sh = read("sh9.glsl", gpu_sh);
    for (std::size_t i = 0; i < n.size(); ++i) {
      const Rgb of_map = irradiance(map, xyz(n[i]) * back);
      const Rgb of_sh = irradiance(gpu_sh.matrices, xyz(n[i]) * back);
      for (unsigned c = 0; c < 3; ++c) {
        ASSERT_NEAR(by_map[i][c], of_map[c], 1e-3F * of_map[c]) << turn_rad;
        ASSERT_NEAR(by_sh[i][c], of_sh[c], 1e-3F * of_sh[c] + 1e-3F) << turn_rad;
      }
    }
  }
}

// Four turns of one mesh, all different, and a table that does not turn, under an environment that does.
TEST_F(RuntimeTurned, OccludersReadTheTwoNearestTurns) {
  const SyntheticSky sky = synthetic_sky(1);
  const DifMap difmap = synthetic_difmap(sky, 32);
  std::vector<FivSet> sets(2);
  sets[1].turns.push_back(synthetic_table(sky, {32, 17, 15}, 1, uneven_radii(15, 0.35F, 8), 9));
  for (unsigned k = 0; k < 4; ++k)
    sets[0].turns.push_back(synthetic_table(sky, {24, 13, 9}, 6, uneven_radii(9, 0.3F, 6), k));
  GpuFivTables gpu = upload(sets);
  EXPECT_TRUE(gpu.turns());
  GpuDifMap unshadowed = upload(difmap);
  const float turn_rad = 0.9F;
  unshadowed.turn_rad = turn_rad;
  std::vector<GpuFivOccluder> occluders;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> u(0, 1);
  for (int i = 0; i < 12; ++i) {
    GpuFivOccluder o;
    o.center_m = V3f(10 * u(random) - 5, 3 * u(random), 10 * u(random) - 5);
    o.radius_m = 0.5F + u(random);
    o.table = i % 3 == 2 ? 1 : 0;
    // What does not turn must go round with the environment.
    o.turn_rad = o.table == 1 ? turn_rad : 8 * u(random) - 4;
    occluders.push_back(o);
  }
  occluders[0].turn_rad = turn_rad + 0.5F * pi;  // one of the tables alone
  set_occluders(gpu, occluders, turn_rad);
  std::vector<std::vector<V4f>> in(2);
  for (int i = 0; i < 5000; ++i) {
    in[0].emplace_back(12 * u(random) - 6, i % 2 == 0 ? 0 : 3 * u(random), 12 * u(random) - 6, 0);
    in[1].push_back(to_v4(i % 2 == 0 ? V3f(0, 1, 0) : random_direction(random)));
  }
  const M33f back = turn_about_y(-double(turn_rad));
  for (const int self : {-1, 0, 4}) {
    // By rule none no order of shadows counts, which rounding could exchange.
    const FivLightParams params{Straddling::bound, FivOverlap::none};
    const std::vector<V4f> e = evaluate_on_gpu(
        fiv_defines(params.overlap, self >= 0, gpu.turns()) +
            "#include \"ambient/fiv.glsl\"\n"
            "vec4 evaluate(int i) { return vec4(ivory_ambient(input0(i).xyz, input1(i).xyz, input1(i).xyz), 1.0); }",
        in, [&](gl::Program& program) { bind(gpu, unshadowed, program, 0, params.straddling, self); });
    std::vector<FivPlacement> placements;
    for (const GpuFivOccluder& o : occluders) {
      const FivSet& set = sets[std::size_t(o.table)];
      const FivPlacement at{&set.turns.front(), o.center_m * back, o.radius_m};
      const auto placement = turned_placement(set, at, double(o.turn_rad) - double(turn_rad));
      ASSERT_TRUE(placement);
      placements.push_back(*placement);
    }
    EXPECT_NE(placements[1].next, nullptr);
    EXPECT_EQ(placements[0].next, nullptr);
    double shadowed = 0;
    for (std::size_t i = 0; i < in[0].size(); ++i) {
      const V3f n = xyz(in[1][i]) * back;
      const Rgb all = irradiance(difmap, n);
      const Rgb expected = fiv_irradiance(placements, xyz(in[0][i]) * back, n, self, all, params);
      // What is left out as negligible may differ: a thousandth of the light.
      for (unsigned c = 0; c < 3; ++c) ASSERT_NEAR(e[i][c], expected[c], 2e-3F * all[c]) << i << " self " << self;
      shadowed += double(1 - luminance(expected) / luminance(all)) / double(in[0].size());
    }
    EXPECT_GT(shadowed, 0.05);
  }
}

TEST_F(RuntimeTurned, OneTableDoesNotTurn) {
  const SyntheticSky sky = synthetic_sky(1);
  const std::vector<FivTable> tables{synthetic_table(sky, {8, 5, 4}, 1, uneven_radii(4, 0.5F, 4), 1)};
  GpuFivTables gpu = upload(tables);
  GpuFivOccluder occluder;
  set_occluders(gpu, {&occluder, 1});
  occluder.turn_rad = 0.3F;
  EXPECT_FALSE(can_turn(gpu, occluder));
  EXPECT_TRUE(can_turn(gpu, occluder, 0.3F));  // with its environment it may
  const std::string said = error_of([&] { set_occluders(gpu, {&occluder, 1}); });
  EXPECT_NE(said.find("--turns"), std::string::npos) << said;
  set_occluders(gpu, {&occluder, 1}, 0.3F);
}

}  // namespace
}  // namespace ivory
