// Fitting tables' values, and counting light that several occluders hide.
#include <cmath>

#include <gtest/gtest.h>

#include "grid/fiv/light.h"
#include "tools/stability/fiv_shapes.h"
#include "tracer/bake/fiv/baker.h"
#include "tracer/bake/fiv/fit.h"

namespace ivory {
namespace {

const V3i size(24, 9, 6);
const std::vector<float> radii{0.5F, 0.7F, 1.0F, 1.5F, 2.5F, 4.0F};

// Values over the samples of `at_size` that depend on one coordinate alone (0 to 1 along that axis), times the falloff.
template <typename Function>
std::vector<float> sampled(const V3i& at_size, const std::vector<float>& at_radii, int axis, const Function& f) {
  std::vector<float> values;
  for (int k = 0; k < at_size.z; ++k) {
    for (int p = 0; p < at_size.y; ++p) {
      for (int a = 0; a < at_size.x; ++a) {
        const float t[3] = {float(a) / float(at_size.x), float(p) / float(at_size.y - 1),
                            float(k) / float(at_size.z - 1)};
        values.push_back(f(t[axis]) * fiv_falloff(at_radii[std::size_t(k)]));
      }
    }
  }
  return values;
}

TEST(FivFit, KeepsWhatInterpolationAlreadyMeets) {
  const auto line = [](float t) { return 2 - 3 * t; };
  for (const int axis : {1, 2}) {
    const std::vector<float> exact = sampled(size, radii, axis, line);
    const std::vector<float> smooth = fit_smooth(exact, size, radii, 1);
    const std::vector<float> refined =
        fit_refined(sampled(refined_size(size, 2), refined_radii(radii, 2), axis, line), size, radii, 2, 1);
    for (std::size_t i = 0; i < exact.size(); ++i) {
      EXPECT_NEAR(smooth[i], exact[i], 1e-5F);
      EXPECT_NEAR(refined[i], exact[i], 1e-5F);
    }
  }
}

// A wave of 24 samples: sampled, its trilinear interpolant errs by sqrt(1/30) h^2 f''/2 RMS; fitted by sqrt(1/180).
TEST(FivFit, LeavesLessThanHalfOfTheErrorOfAWave) {
  const auto wave = [](float t) { return std::sin(2 * pi * t); };
  const auto error = [&](const std::vector<float>& values) {
    double squares = 0;
    constexpr int points = 2400;
    for (int i = 0; i < points; ++i) {
      const double t = double(i) / points;
      const int low = int(t * size.x);
      const double u = t * size.x - low;
      const double value =
          (1 - u) * double(values[std::size_t(low)]) + u * double(values[std::size_t((low + 1) % size.x)]);
      squares += std::pow(value - double(wave(float(t))), 2);
    }
    return std::sqrt(squares / points);
  };
  const double h = 2 * double(pi) / size.x;
  const std::vector<float> exact = sampled(size, radii, 0, wave);  // the first row has radius 0.5: falloff 1
  const double curvature = h * h / 2 * std::sqrt(0.5);
  EXPECT_NEAR(error(exact), std::sqrt(1 / 30.0) * curvature, 0.02 * curvature);
  EXPECT_NEAR(error(fit_smooth(exact, size, radii, 1)), std::sqrt(1 / 180.0) * curvature, 0.02 * curvature);
  const auto refined = [&](int m) {
    return fit_refined(sampled(refined_size(size, m), refined_radii(radii, m), 0, wave), size, radii, m, 1);
  };
  EXPECT_NEAR(error(refined(4)), std::sqrt(1 / 180.0) * curvature, 0.02 * curvature);
  EXPECT_LT(error(refined(2)), 0.5 * error(exact));
}

class TwoBalls : public testing::Test {
 protected:
  static const FivTable& table() {
    static const FivTable baked = [] {
      FivParams params;
      params.samples = {48, 25, 16};
      params.hemispheres = 6;
      params.environment_size = 24;
      return bake_fiv(make_fiv_occluder(ball_scene()), uniform_cube(Rgb(1, 1, 1), 24), params);
    }();
    return baked;
  }
  static float hidden(const std::vector<FivPlacement>& occluders, FivOverlap overlap) {
    return pi -
           fiv_irradiance(occluders, V3f(0, 0, 0), V3f(0, 1, 0), -1, Rgb(pi, pi, pi), {Straddling::bound, overlap}).x;
  }
};

TEST_F(TwoBalls, OneBehindTheOtherHidesNothingMore) {
  const FivPlacement near{&table(), V3f(0, 3, 0), 1};
  const FivPlacement far{&table(), V3f(0, 9, 0), 2.9F};  // a little less wide as seen from the receiver
  const float alone = hidden({near}, FivOverlap::covers);
  // The ball covers 96 of the 3456 lights, give or take those that its edge cuts.
  EXPECT_NEAR(alone, pi / 9, 0.08F * pi / 9);
  // Balls fill their discs to a tessellation's and a picture's worth.
  EXPECT_NEAR(hidden({near, far}, FivOverlap::covers), alone, 0.04F * alone);
  EXPECT_NEAR(hidden({near, far}, FivOverlap::discs), alone, 0.04F * alone);
  EXPECT_GT(hidden({near, far}, FivOverlap::none), 1.8F * alone);
  EXPECT_GT(hidden({near, far}, FivOverlap::product), 1.7F * alone);
}

TEST_F(TwoBalls, SideBySideHideBoth) {
  const FivPlacement left{&table(), V3f(-2, 3, 0), 1};
  const FivPlacement right{&table(), V3f(2, 3, 0), 1};
  const float sum = hidden({left}, FivOverlap::none) + hidden({right}, FivOverlap::none);
  for (const FivOverlap overlap : {FivOverlap::none, FivOverlap::discs, FivOverlap::covers})
    EXPECT_NEAR(hidden({left, right}, overlap), sum, 1e-4F * sum);
}

// Far balls of many distances, most of them left out: what they hide, all together, stays below the promise.
TEST_F(TwoBalls, LeaveOutNoMoreThanIsNegligible) {
  const float most = most_hidden(table());
  // Outside a disc of pi sin^2 is hidden; all directions, inside, would be pi for both halves of the sphere.
  EXPECT_GT(most, pi);
  EXPECT_LE(most, 2 * pi);
  std::vector<FivPlacement> all;
  for (int i = 0; i < 100; ++i) {
    const float r = 20 * std::pow(1.06F, float(i));
    all.push_back({&table(), V3f(r * std::cos(float(i)), 0.7F * r, r * std::sin(float(i))), 1});
  }
  std::vector<FivPlacement> some = all;
  for (FivPlacement& placement : some) placement.most_hidden = most;
  const float lost = hidden(all, FivOverlap::none) - hidden(some, FivOverlap::none);
  EXPECT_GT(lost, 0.0F);
  EXPECT_LE(lost, fiv_negligible * pi + 2e-6F);
}

TEST_F(TwoBalls, NeverLeaveLessThanNothing) {
  std::vector<FivPlacement> many;
  for (int i = 0; i < 40; ++i)
    many.push_back({&table(), V3f(2.2F * std::cos(float(i)), 1.2F + 0.02F * float(i), 2.2F * std::sin(float(i))), 1});
  for (const FivOverlap overlap : {FivOverlap::none, FivOverlap::discs, FivOverlap::covers, FivOverlap::product}) {
    for (int self = -1; self < 2; ++self) {
      const Rgb e =
          fiv_irradiance(many, V3f(0, 0, 0), V3f(0, 1, 0), self, Rgb(pi, pi, 0), {Straddling::bound, overlap});
      for (unsigned c = 0; c < 3; ++c) {
        EXPECT_GE(e[c], 0);
        EXPECT_LE(e[c], pi);
      }
    }
  }
}

}  // namespace
}  // namespace ivory
