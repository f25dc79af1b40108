// Irradiance at points against closed forms, and the honesty of its standard errors.
#include "tracer/render/probe.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/lit_scene.h"
#include "tracer/core/sampling.h"

namespace ivory {
namespace {

TEST(Probe, ClosedForms) {
  Scene scene;
  const int black = add_lambert(scene, Rgb(0, 0, 0));
  add_mesh(scene, make_quad({-1, -5, -1}, {0, 0, 2}, {2, 0, 0}, black));
  scene.environment = uniform_environment({3, 3, 3});
  scene.lights.push_back(PointLight{V3f(0, 2, 0), Rgb(8, 8, 8)});
  const LitScene lit = make_lit_scene(std::move(scene));
  const V3f up(0, 1, 0);
  ProbeParams params;
  params.samples = 20000;
  const auto results = probe_scene(lit, {{V3f(0, 0, 0), up}}, params);
  const double truth = 3 * double(pi) + 8.0 / 4;
  ASSERT_EQ(results.size(), 1U);
  EXPECT_LT(std::abs(double(results[0].e.x) - truth), z_limit * double(results[0].standard_error.x));
  EXPECT_LT(results[0].standard_error.x, 0.02 * truth);
}

TEST(Probe, FurnaceAndIndirectOnly) {
  const LitScene lit = make_lit_scene(furnace(0.5F, Rgb(1, 1, 1)));
  const V3f up(0, 1, 0);
  std::vector<ProbePoint> points{{V3f(0, 0, 0), up}, {V3f(0.3F, -1, 0.2F), up}, {V3f(0.5F, 0.5F, 1), V3f(0, 0, -1)}};
  ProbeParams params;
  params.samples = 20000;
  for (const bool indirect_only : {false, true}) {
    params.indirect_only = indirect_only;
    for (const ProbeResult& r : probe_scene(lit, points, params)) {
      // L = 2 everywhere, of which 1 comes straight from the walls.
      const double truth = double(pi) * (indirect_only ? 1 : 2);
      EXPECT_LT(std::abs(double(r.e.y) - truth), z_limit * double(r.standard_error.y) + 1e-6 * truth);
    }
  }
}

// Scaled errors of many points must look like unit normals: the sum of squares is chi-square.
TEST(Probe, StandardErrorsAreHonest) {
  const LitScene lit = make_lit_scene(furnace(0.7F, Rgb(1, 1, 1)));
  std::vector<ProbePoint> points;
  RandomStream random(5, StreamPurpose::test, 0);
  for (int i = 0; i < 400; ++i) points.push_back({sample_sphere(random.next2()) * 0.5F, sample_sphere(random.next2())});
  ProbeParams params;
  params.samples = 256;
  double chi2 = 0;
  for (const ProbeResult& r : probe_scene(lit, points, params)) {
    const double z = (double(r.e.x) - double(pi) / 0.3) / double(r.standard_error.x);
    chi2 += z * z;
  }
  // 400 degrees of freedom have a standard deviation of 28; the estimates' own skew adds some 5 %.
  EXPECT_NEAR(chi2, 400, 4 * 28 + 20);
}

TEST(Probe, DoesNotDependOnThreads) {
  const LitScene lit = make_lit_scene(small_room());
  std::vector<ProbePoint> points(10, {V3f(0, 0, 0), V3f(0, 1, 0)});
  ProbeParams params;
  params.samples = 16;
  params.threads = 1;
  const auto a = probe_scene(lit, points, params);
  params.threads = 2;
  const auto b = probe_scene(lit, points, params);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(a[i].e, b[i].e);
  EXPECT_NE(a[0].e, a[1].e);  // points have streams of their own
}

}  // namespace
}  // namespace ivory
