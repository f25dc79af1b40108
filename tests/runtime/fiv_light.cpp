// The light among many FIV occluders in GLSL against C++.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "runtime/assets/fiv.h"
#include "tests/runtime/fiv_synthetic.h"
#include "tests/support/runtime_twin.h"

namespace ivory {
namespace {

class RuntimeFivLight : public GlTest {
 protected:
  struct World {
    std::vector<FivTable> tables;
    std::vector<float> most;
    DifMap difmap;
  };
  static const World& world() {
    static const World the = [] {
      const SyntheticSky sky = synthetic_sky(1);
      World w{synthetic_tables(sky), {}, synthetic_difmap(sky, 32)};
      for (const FivTable& table : w.tables) w.most.push_back(most_hidden(table));
      return w;
    }();
    return the;
  }

  // In a box of 14 x 6 x 14 m, half to two and a half metres wide, every fifth small and far away; all tables in turn.
  static std::vector<GpuFivOccluder> crowd(int count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> u(0, 1);
    std::vector<GpuFivOccluder> out;
    for (int i = 0; i < count; ++i) {
      GpuFivOccluder o;
      o.table = i % int(world().tables.size());
      o.center_m = V3f(14 * u(random) - 7, 6 * u(random), 14 * u(random) - 7);
      o.radius_m = 0.5F + 2 * u(random) * u(random);
      if (i % 5 == 4) {
        o.center_m = random_direction(random) * 200;
        o.radius_m = 0.05F;
      }
      out.push_back(o);
    }
    return out;
  }
  static std::vector<FivPlacement> twin(const std::vector<GpuFivOccluder>& occluders) {
    std::vector<FivPlacement> out;
    for (const GpuFivOccluder& o : occluders)
      out.push_back(
          {&world().tables[std::size_t(o.table)], o.center_m, o.radius_m, world().most[std::size_t(o.table)]});
    return out;
  }

  // Anywhere among them with any normal; every other on the ground, which many of them reach below.
  static std::vector<std::vector<V4f>> receivers() {
    std::mt19937 random(8);
    std::uniform_real_distribution<float> u(0, 1);
    std::vector<std::vector<V4f>> out(2);
    for (int i = 0; i < 10000; ++i) {
      const bool ground = i % 2 == 0;
      out[0].emplace_back(16 * u(random) - 8, ground ? 0 : 6 * u(random), 16 * u(random) - 8, 0);
      out[1].push_back(to_v4(ground ? V3f(0, 1, 0) : random_direction(random)));
    }
    return out;
  }

  struct Difference {
    double largest = 0;   // over the unshadowed light of the channel
    double beyond = 0;    // share of receivers off by more than a thousandth of it
    double shadowed = 0;  // share of the light that is hidden
  };
  template <typename Unshadowed, typename Twin>
  static Difference compare(const std::vector<GpuFivOccluder>& occluders, const Unshadowed& gpu_unshadowed,
                            const Twin& unshadowed, const FivLightParams& params, int self) {
    GpuFivTables gpu = upload(world().tables);
    set_occluders(gpu, occluders);
    const auto in = receivers();
    const std::vector<V4f> e = evaluate_on_gpu(
        fiv_defines(params.overlap, self >= 0) +
            "#include \"ambient/fiv.glsl\"\n"
            "vec4 evaluate(int i) { return vec4(ivory_ambient(input0(i).xyz, input1(i).xyz, input1(i).xyz), 1.0); }",
        in, [&](gl::Program& program) { bind(gpu, gpu_unshadowed, program, 0, params.straddling, self); });
    const std::vector<FivPlacement> placements = twin(occluders);
    Difference out;
    for (std::size_t i = 0; i < in[0].size(); ++i) {
      const V3f n = xyz(in[1][i]);
      const Rgb all = unshadowed(n);
      const Rgb expected = fiv_irradiance(placements, xyz(in[0][i]), n, self, all, params);
      double worst = 0;
      for (unsigned c = 0; c < 3; ++c) {
        EXPECT_TRUE(std::isfinite(e[i][c]));
        if (!(all[c] > 0)) continue;
        worst = std::max(worst, double(std::abs(e[i][c] - expected[c]) / all[c]));
      }
      out.largest = std::max(out.largest, worst);
      out.beyond += worst > 1e-3 ? 1.0 / double(in[0].size()) : 0;
      if (luminance(all) > 0) out.shadowed += double(1 - luminance(expected) / luminance(all)) / double(in[0].size());
    }
    return out;
  }
  static Difference compare(const std::vector<GpuFivOccluder>& occluders, const FivLightParams& params, int self) {
    const GpuDifMap difmap = upload(world().difmap);
    return compare(
        occluders, difmap, [](const V3f& n) { return irradiance(world().difmap, n); }, params, self);
  }
};

TEST_F(RuntimeFivLight, AgreesWithItsTwin) {
  for (const int count : {0, 1, 2, 8, 9, 40, 128}) {
    for (const FivOverlap overlap : {FivOverlap::none, FivOverlap::discs, FivOverlap::covers, FivOverlap::product}) {
      for (const Straddling straddling : {Straddling::bound, Straddling::scale}) {
        if (straddling == Straddling::scale && overlap != FivOverlap::covers) continue;
        const Difference d = compare(crowd(count), {straddling, overlap}, count % 2 == 0 ? -1 : count / 2);
        // Of two shadows as strong as each other to within rounding either may count as the stronger, and the rules do
        // not treat both alike: a few receivers in ten thousand.
        const bool ranked = count > 1 && (overlap == FivOverlap::covers || overlap == FivOverlap::discs);
        EXPECT_LE(d.beyond, ranked ? 3e-4 : 0.0) << count << " occluders, overlap " << int(overlap);
        EXPECT_LT(d.largest, ranked ? 0.03 : 1e-3) << count << " occluders, overlap " << int(overlap);
        if (count > 8) {
          EXPECT_GT(d.shadowed, 0.09);
        }
      }
    }
  }
}

TEST_F(RuntimeFivLight, TakesItsLightFromSh9Too) {
  Sh9 sh;
  sh.coefficients[0] = V3d(90, 80, 120);
  sh.coefficients[1] = V3d(30, 20, 60);
  sh.coefficients[8] = V3d(10, -20, 5);
  const GpuSh9 gpu = upload(sh);
  const Difference d = compare(
      crowd(20), gpu, [&](const V3f& n) { return irradiance(gpu.matrices, n); }, FivLightParams{}, 3);
  EXPECT_LT(d.largest, 1e-3);
}

}  // namespace
}  // namespace ivory
