// Guides: they change how often photons are sent where, and no mean, whatever they were made from.
#include "tracer/lights/guide.h"

#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/emissive_texture.h"
#include "tests/support/lights_check.h"

namespace ivory {
namespace {

constexpr unsigned plane = 3U << axis_place;

// One stratum of the unit square, sampled evenly; `f` is what photons bring.
std::vector<GuideSample> square_samples(const std::function<double(double, double)>& f, int count) {
  const std::vector<GuideStratum> strata{{1, plane, 1, 1}};
  const EmissionGuide even(strata);
  RandomStream random = test_stream();
  std::vector<GuideSample> samples;
  for (int i = 0; i < count; ++i) {
    const GuidePoint p = even.sample(random);
    samples.push_back({p, std::pow(f(p.u[axis_place], p.u[axis_place + 1]), 2)});
  }
  return samples;
}

// Light comes through a window of 0.2 x 0.1 with odds of a tenth, and a little from everywhere.
double window(double x, double y, double chance) {
  const bool in = x > 0.37 && x < 0.57 && y > 0.81 && y < 0.91;
  return in && chance < 0.1 ? 5 : 0.01;
}

TEST(Guide, LowersTheVarianceAndKeepsTheMean) {
  const std::vector<GuideStratum> strata{{1, plane, 1, 1}};
  RandomStream chance = test_stream(1);
  const auto f = [&](double x, double y) { return window(x, y, double(chance.next())); };
  constexpr double defensive = 0.125;
  const EmissionGuide guide = make_guide(strata, square_samples(f, 20'000), defensive);
  EXPECT_GT(guide.cells(), 4U);
  RandomStream random = test_stream(2);
  Accumulator mean;
  Accumulator one;
  Accumulator even;
  for (int i = 0; i < 100'000; ++i) {
    const GuidePoint p = guide.sample(random);
    ASSERT_GE(p.density, 0.999 * defensive);
    ASSERT_LE(p.density, 1.001 * guide.largest_density(0));
    mean.add(f(p.u[axis_place], p.u[axis_place + 1]) / p.density);
    one.add(1 / p.density);
    even.add(f(double(random.next()), double(random.next())));
  }
  EXPECT_LT(std::abs(z_score(mean, 0.02 * 0.1 * 5 + 0.01 * (1 - 0.002))), z_limit);
  EXPECT_LT(std::abs(z_score(one, 1)), z_limit);
  // Of the best there is, (sum of roots)^2 = (0.02 sqrt(2.5) + 0.98 0.01)^2 = 1 / 29 of 0.05, at least a third.
  EXPECT_LT(mean.variance() * 10, even.variance());
}

// Noise is not structure, and nothing seen is nothing learnt.
TEST(Guide, LeavesAloneWhatIsEven) {
  const std::vector<GuideStratum> strata{{1, plane, 1, 1}};
  RandomStream chance = test_stream(1);
  // Heavy-tailed: the square's own variance is infinite.
  const auto f = [&](double, double) { return std::pow(double(chance.next()) + 1e-9, -0.3); };
  const EmissionGuide guide = make_guide(strata, square_samples(f, 5000), 0.125);
  EXPECT_GT(guide.least_density(0), 0.5);
  const EmissionGuide dark = make_guide(strata, square_samples([](double, double) { return 0.0; }, 5000), 0.125);
  EXPECT_EQ(dark.cells(), 1U);
  EXPECT_NEAR(dark.least_density(0), 1, 1e-9);
}

// A cell without light keeps what its few photons cannot rule out.
TEST(Guide, TrustsFewPhotonsLittle) {
  const std::vector<GuideStratum> strata{{0.99, plane, 1, 1}, {0.01, plane, 1, 1}};
  std::vector<GuideSample> samples;
  RandomStream random = test_stream();
  const EmissionGuide even(strata);
  for (int i = 0; i < 300; ++i) {
    const GuidePoint p = even.sample(random);
    samples.push_back({p, p.stratum == 0 ? 1.0 : 0.0});
  }
  // About three photons of the second brought nothing: sqrt(2 / 5) of the density is left, not the defensive share.
  const double left = make_guide(strata, samples, 0.01).least_density(1);
  EXPECT_GT(left, 0.35);
  EXPECT_LT(left, 1);
}

struct Lamps {
  std::string name;
  Scene scene;
};

Scene ground() {
  Scene scene;
  const int grey = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
  add_mesh(scene, make_quad({-40, 0, -40}, {0, 0, 80}, {80, 0, 0}, grey));
  return scene;
}

void add_sun(Scene& scene) { scene.lights.push_back(DirectionalLight{V3f(0.3F, -1, 0.2F).normalized(), Rgb(3, 2, 1)}); }
void add_sky(Scene& scene) {
  EnvironmentMap map;
  map.width = 7;
  map.height = 4;
  for (int i = 0; i < 28; ++i) map.radiance.push_back(Rgb(float(i % 5), float(i % 3), i == 9 ? 200.0F : 1.0F));
  scene.environment = map;
}
void add_spot(Scene& scene) {
  SpotLight spot;
  spot.position = V3f(1, 6, 2);
  spot.direction = V3f(0.4F, -1, 0.1F).normalized();
  spot.intensity_cd = Rgb(500, 400, 100);
  spot.inner_angle_rad = 0.3F;
  spot.outer_angle_rad = 0.8F;
  scene.lights.push_back(spot);
}
void add_panel(Scene& scene, bool textured, bool double_sided) {
  const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(100, 50, 20), double_sided);
  if (textured) {
    scene.materials[std::size_t(lamp)].emission_texture.texture = add_texture(scene, 6, 5, [](int x, int y) {
      return Texel{std::uint8_t(40 * x), std::uint8_t(x == y ? 255 : 0), 90, 255};
    });
  }
  add_mesh(scene, make_quad({-3, 5, 1}, {2, 0.5F, 0}, {0, 0, 1}, lamp));
}

std::vector<Lamps> all_lamps() {
  std::vector<Lamps> out;
  const auto add = [&](const std::string& name, const std::function<void(Scene&)>& fill) {
    Lamps lamps{name, ground()};
    fill(lamps.scene);
    out.push_back(std::move(lamps));
  };
  add("sun", add_sun);
  add("sky", add_sky);
  add("point", [](Scene& s) { s.lights.push_back(point_at({2, 5, 1}, {100, 50, 20})); });
  add("spot", add_spot);
  add("panel", [](Scene& s) { add_panel(s, false, false); });
  add("textured panel of two sides", [](Scene& s) { add_panel(s, true, true); });
  // More than 4096 triangles in all, chosen by instance.
  add("many panels", [](Scene& s) {
    add_panel(s, true, false);
    const Instance panel = s.instances.back();
    for (int i = 0; i < 2100; ++i) {
      Instance next = panel;
      next.to_world.setTranslation(V3f(float(i % 50) - 20, 0.1F * float(i % 9), float(i / 50) - 20));
      s.instances.push_back(next);
    }
  });
  add("all", [](Scene& s) {
    add_sun(s);
    add_sky(s);
    add_spot(s);
    for (int i = 0; i < 700; ++i)
      s.lights.push_back(point_at({float(i % 20), 5, float(i / 20)}, {1, float(i % 4), 20}));
    add_panel(s, true, true);
  });
  return out;
}

// Flux, and its moments by place and direction, of photons that are sent by a guide that was made from nonsense,
// against those of photons that are not: 9 numbers for each kind of light, z within 4 each.
TEST(Guide, ChangesNoMeanOfAnyLight) {
  for (Lamps& lamps : all_lamps()) {
    const LitScene lit = make_lit_scene(std::move(lamps.scene));
    const Lights::Emission base = lit.lights.emission(EmissionTarget{V3f(5, 1, -3), 2, false});
    const Lights::Emission even = lit.lights.guidable(base);
    RandomStream learn = test_stream(7);
    std::vector<GuideSample> samples;
    double shares = 0;
    for (const GuideStratum& s : even.strata()) shares += s.share;
    EXPECT_NEAR(shares, 1, 1e-6) << lamps.name;
    for (int i = 0; i < 30'000; ++i) {
      const GuidePoint p = even.guide().sample(learn);
      const double x = p.u[1] - 0.3;
      const double y = p.u[3] + p.u[0] - 0.6;
      samples.push_back({p, std::exp(-30 * (x * x + y * y)) * (p.stratum % 2 == 0 ? 1 : 0.01)});
    }
    const Lights::Emission guided = even.guided(make_guide(even.strata(), samples, 0.1), 0);
    EXPECT_GT(guided.guide().cells(), even.guide().cells()) << lamps.name;
    const auto moments = [&](const Lights::Emission& emission, std::uint64_t stream) {
      std::vector<Accumulator> out(9);
      RandomStream random = test_stream(stream);
      for (int i = 0; i < 60'000; ++i) {
        const EmittedPhoton photon = lit.lights.emit(emission, random);
        const V3f& o = photon.origin;
        const V3f& d = photon.direction;
        // Of what comes near, where photons through the discs of a target all weigh about the same.
        const V3f off = (o - V3f(5, 1, -3)).cross(d);
        const bool near = off.length() < 20;
        const double p = near ? double(photon.power.x) : 0;
        out[0].add(p);
        out[1].add(near ? double(photon.power.z) : 0);
        for (unsigned c = 0; c < 3; ++c) {
          out[2 + c].add(p * double(off[c]));
          out[5 + c].add(p * double(d[c]));
        }
        out[8].add(p * double(d.x) * double(off.y));
      }
      return out;
    };
    const auto a = moments(base, 11);
    const auto b = moments(guided, 12);
    for (std::size_t k = 0; k < a.size(); ++k)
      EXPECT_LT(std::abs(z_score(b[k], a[k])), z_limit)
          << lamps.name << " " << k << ": " << b[k].mean() << " and " << a[k].mean();
  }
}

}  // namespace
}  // namespace ivory
