// Which lights are sampled for a surface: by what they give there, with probabilities that are what they say.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/lights_check.h"
#include "tests/support/lit_scene.h"
#include "tracer/core/sampling.h"

namespace ivory {
namespace {

V3f point_in(RandomStream& random, const V3f& half) {
  return V3f(2 * random.next() - 1, 2 * random.next() - 1, 2 * random.next() - 1) * half;
}

// Lamps and panels to all sides over a field of 100 m, their powers spread over four decades. Surfaces are black.
Scene field_of_lights(int lamps, int panels, std::uint64_t seed) {
  Scene scene = {};
  const int black = add_lambert(scene, Rgb(0, 0, 0));
  add_mesh(scene, make_quad({-60, -4, -60}, {0, 0, 120}, {120, 0, 0}, black));
  RandomStream random = test_stream(seed);
  const auto strength = [&] { return std::pow(10.0F, 4 * random.next() - 2); };
  for (int i = 0; i < lamps; ++i) {
    const V3f at = point_in(random, {50, 3, 50});
    const Rgb intensity = Rgb(1, 0.8F, 0.5F) * strength();
    if (i % 3 == 2) {
      scene.lights.push_back(SpotLight{at, sample_sphere(random.next2()), intensity, 0.3F, 0.9F});
    } else {
      scene.lights.push_back(PointLight{at, intensity});
    }
  }
  for (int i = 0; i < panels; ++i) {
    const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(1, 1, 1) * strength(), i % 2 == 0);
    const ShadingFrame frame = make_shading_frame(sample_sphere(random.next2()));
    add_mesh(scene, make_quad(point_in(random, {50, 3, 50}), frame.x, frame.y, lamp));
  }
  return scene;
}

// The irradiance of a sample on the receiver, unshadowed.
double given(const LightSample& s, const Receiver& receiver) {
  return double(s.irradiance_weight.x) * std::max(0.0, double(s.w.dot(receiver.n)));
}

Accumulator irradiance(const Lights& lights, const Receiver& receiver, LightPick pick, int count) {
  RandomStream random = test_stream();
  Accumulator e;
  for (int k = 0; k < count; ++k) {
    double sum = 0;
    for (int i = 0; i < lights.samples(pick); ++i) {
      if (const auto s = lights.sample(receiver, pick, i, random)) sum += given(*s, receiver);
    }
    e.add(sum);
  }
  return e;
}

std::vector<Receiver> receivers(int count) {
  RandomStream random = test_stream(99);
  std::vector<Receiver> out;
  for (int i = 0; i < count; ++i) out.push_back({point_in(random, {45, 3, 45}), sample_sphere(random.next2())});
  return out;
}

// Lights in a row, in a plane and at one place, too.
std::vector<LightBounds> bounds_of_lamps(int count, const V3f& spread) {
  RandomStream random = test_stream(3);
  std::vector<LightBounds> out;
  for (int i = 0; i < count; ++i) {
    LightBounds b;
    const V3f at = point_in(random, spread);
    b.box.extendBy(at);
    b.box.extendBy(at + point_in(random, {0.3F, 0.3F, 0.3F}));
    b.axis = sample_sphere(random.next2());
    b.spread_rad = i % 3 == 0 ? 0.0F : random.next() * pi;
    b.reach_rad = i % 4 == 0 ? 0.4F : pi / 2;
    b.two_sided = i % 5 == 0;
    b.intensity_cd = i % 7 == 0 ? 0.0F : std::exp(4 * random.next());
    out.push_back(b);
  }
  return out;
}

// Counts of picks against the probabilities stated, and these against 1. A score above 4 is a false alarm once in
// 30,000 tests.
TEST(LightTree, PicksWithTheProbabilitiesThatItStates) {
  for (const V3f& spread : {V3f(10, 3, 10), V3f(10, 0, 0), V3f(0, 0, 0)}) {
    const std::vector<LightBounds> bounds = bounds_of_lamps(100, spread);
    std::vector<std::vector<std::uint32_t>> groups(30);
    for (std::uint32_t i = 0; i < bounds.size(); ++i) groups[i * 7 % 30].push_back(i);
    const LightTree tree(bounds, groups);
    RandomStream random = test_stream(4);
    for (int k = 0; k < 5; ++k) {
      const Receiver receiver{point_in(random, {8, 2, 8}), k == 4 ? V3f(0, 0, 0) : sample_sphere(random.next2())};
      constexpr int picks = 40'000;
      std::vector<double> counts(bounds.size(), 0);
      for (int i = 0; i < picks; ++i) {
        const auto picked = tree.pick(tree.root(), receiver, double(random.next_u32()) * 0x1p-32);
        if (!picked) continue;
        counts[picked->light] += 1;
        ASSERT_GE(picked->u, 0);
        ASSERT_LT(picked->u, 1);
        const float stated = tree.probability(tree.root(), tree.light_node(picked->light), receiver);
        ASSERT_NEAR(picked->probability, stated, 1e-5F * stated);  // float products in another order
      }
      std::vector<double> expected(bounds.size(), 0);
      double total = 0;
      for (std::uint32_t i = 0; i < bounds.size(); ++i) {
        if (tree.light_node(i) != LightTree::no_node)
          expected[i] = picks * double(tree.probability(tree.root(), tree.light_node(i), receiver));
        total += expected[i] / picks;
        EXPECT_TRUE(bounds[i].intensity_cd > 0 || expected[i] == 0);
      }
      // What falls to clusters whose bounds reach the receiver though none of their lights does is lost.
      EXPECT_LT(total, 1 + 1e-4);
      double picked = 0;
      for (const double c : counts) picked += c;
      counts.push_back(picks - picked);
      expected.push_back(picks * std::max(0.0, 1 - total));
      if (total < 0.01) continue;  // a receiver that hardly anything reaches: nothing to tell apart
      EXPECT_LT(chi_square_score(counts, expected), 4) << spread << " " << k;
    }
  }
}

// Every light alone gives what it gives among the others: its samples have a probability above 0 wherever it reaches,
// and the mean of the estimate is the sum. One false alarm in 15,800 a receiver.
TEST(LightChoice, FindsAllLight) {
  const LitScene lit = make_lit_scene(field_of_lights(60, 40, 1));
  for (const Receiver& receiver : receivers(12)) {
    // By the table that knows nothing of the place.
    RandomStream random = test_stream(5);
    Accumulator by_power;
    for (int i = 0; i < 400'000; ++i) {
      const auto s = lit.lights.sample(receiver.p, random);
      by_power.add(s ? given(*s, receiver) : 0.0);
    }
    const Accumulator by_place = irradiance(lit.lights, receiver, LightPick::one, 40'000);
    EXPECT_LT(std::abs(z_score(by_place, by_power)), z_limit);
  }
}

// Ten thousand lamps are sampled nearly as well as ten, and far better than by power: summed over receivers, the
// variance in units of E^2.
TEST(LightChoice, ManyLampsAreAsGoodAsFew) {
  double of_many = 0;
  double by_power = 0;
  double of_few = 0;
  const LitScene many = make_lit_scene(field_of_lights(9000, 1000, 2));
  const LitScene few = make_lit_scene(field_of_lights(7, 3, 2));
  for (const Receiver& receiver : receivers(20)) {
    const auto relative = [](const Accumulator& e) { return e.variance() / (e.mean() * e.mean() + 1e-30); };
    const Accumulator e = irradiance(many.lights, receiver, LightPick::one, 10'000);
    of_many += relative(e);
    of_few += relative(irradiance(few.lights, receiver, LightPick::one, 10'000));
    RandomStream random = test_stream(6);
    Accumulator p;
    for (int i = 0; i < 10'000; ++i) {
      const auto s = many.lights.sample(receiver.p, random);
      p.add(s ? given(*s, receiver) : 0.0);
    }
    by_power += p.variance() / (e.mean() * e.mean());
  }
  EXPECT_LT(of_many, 8 * of_few);  // 5.3 times as measured, for a thousand times the lamps

  EXPECT_LT(of_many, 0.03 * by_power);  // a seventieth
}

// The density at a hit is that of the samples: the integral of both estimators' weights is 1 for every light.
TEST(LightChoice, DensitiesAreThoseOfSamples) {
  Scene scene = field_of_lights(3, 6, 3);
  scene.environment = uniform_environment({3, 3, 3});
  scene.lights.push_back(DirectionalLight{V3f(0.1F, -1, 0).normalized(), Rgb(2, 2, 2)});
  const LitScene lit = make_lit_scene(std::move(scene));
  RandomStream random = test_stream();
  for (const LightPick pick : {LightPick::one, LightPick::each}) {
    int compared = 0;
    for (const Receiver& receiver : receivers(200)) {
      for (int i = 0; i < lit.lights.samples(pick); ++i) {
        const auto s = lit.lights.sample(receiver, pick, i, random);
        if (!s || s->delta) continue;
        ++compared;
        if (!std::isfinite(s->distance_m)) {
          const float pdf = lit.lights.environment_pdf_solid_angle(receiver, s->w, pick);
          EXPECT_NEAR(pdf, s->pdf_solid_angle, 1e-4F * pdf);
          continue;
        }
        const auto hit = lit.intersector.closest({.origin = s->point - s->w * 0.01F, .direction = s->w});
        if (!hit || hit->t > 0.02F) continue;
        // A hit's place is off by 1e-5 m at 50 m, and at grazing angles the density goes with the cosine.
        const float pdf = lit.lights.pdf_solid_angle(receiver, *hit, pick);
        if (std::abs(s->ng.dot(s->w)) < 0.05F) continue;
        EXPECT_NEAR(pdf, s->pdf_solid_angle, 5e-3F * pdf);
      }
    }
    EXPECT_GT(compared, 100);
  }
}

// Up to four lights are sampled each; a sun, a sky and many lamps as three.
TEST(LightChoice, FewLightsAreSampledEach) {
  Scene scene = field_of_lights(2, 1, 4);
  EXPECT_EQ(make_lit_scene(scene).lights.samples(LightPick::each), 3);
  scene.environment = uniform_environment({1, 1, 1});
  EXPECT_EQ(make_lit_scene(scene).lights.samples(LightPick::each), 4);
  scene.lights.push_back(DirectionalLight{V3f(0, -1, 0), Rgb(1, 1, 1)});
  EXPECT_EQ(make_lit_scene(scene).lights.samples(LightPick::each), 3);
  for (int i = 0; i < 3; ++i) scene.lights.push_back(DirectionalLight{V3f(0, -1, 0), Rgb(1, 1, 1)});
  EXPECT_EQ(make_lit_scene(scene).lights.samples(LightPick::each), 1);
  for (const Receiver& receiver : receivers(6)) {
    const LitScene lit = make_lit_scene(field_of_lights(2, 1, 4));
    const Accumulator each = irradiance(lit.lights, receiver, LightPick::each, 40'000);
    EXPECT_LT(std::abs(z_score(each, irradiance(lit.lights, receiver, LightPick::one, 40'000))), z_limit);
  }
}

// A lamp behind the receiver or at its very place, and one that stands far below its horizon, do no harm.
TEST(LightChoice, LightsThatDoNotReachAreNotSampled) {
  Scene scene;
  scene.lights.push_back(PointLight{V3f(0, -1, 0), Rgb(1, 1, 1)});
  scene.lights.push_back(PointLight{V3f(1, -2, 0), Rgb(1, 1, 1)});
  const LitScene lit = in_black_box(std::move(scene));
  RandomStream random = test_stream();
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(lit.lights.sample({V3f(0, 0, 0), V3f(0, 1, 0)}, LightPick::one, 0, random));
    const auto at_lamp = lit.lights.sample({V3f(0, -1, 0), V3f(0, 1, 0)}, LightPick::one, 0, random);
    EXPECT_FALSE(at_lamp && !std::isfinite(at_lamp->irradiance_weight.x));
  }
}

}  // namespace
}  // namespace ivory
