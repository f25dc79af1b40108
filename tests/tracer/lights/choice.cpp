// Who is picked among many lights, and where shadow rays end: strong and weak lights in one scene, coloured
// ones, lamps far away and emitters close by.
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/lights_check.h"
#include "tests/support/lit_scene.h"
#include "tracer/core/alias_table.h"
#include "tracer/core/sampling.h"
#include "tracer/core/surface.h"
#include "tracer/render/probe.h"

namespace ivory {
namespace {

// First of the 32-bit numbers that ask entry i of n.
std::uint32_t first_asking(std::uint64_t i, std::uint64_t n) { return std::uint32_t(((i << 32U) + n - 1) / n); }

// The probabilities that a table states are those that its picks have: each entry's threshold found by bisection.
TEST(AliasTable, StatesTheProbabilitiesOfItsIntegers) {
  std::vector<double> weights;
  for (int i = 0; i < 97; ++i) weights.push_back(i % 10 == 3 ? 0.0 : std::pow(10.0, -12.0 * i / 96));
  const AliasTable table(weights);
  const std::vector<double> stated = table.probabilities();
  std::vector<double> found(weights.size(), 0);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const std::uint32_t u = first_asking(i, weights.size());
    std::uint64_t stays = 0;  // u_keep below this stays
    std::uint64_t leaves = std::uint64_t(1) << 32U;
    const std::uint32_t alias = table.pick(u, 0xffffffffU);
    if (alias == i) {
      stays = leaves;
    } else {
      while (stays < leaves) {
        const std::uint64_t middle = (stays + leaves) / 2;
        if (table.pick(u, std::uint32_t(middle)) == i) {
          stays = middle + 1;
        } else {
          leaves = middle;
        }
      }
    }
    const std::uint64_t next = i + 1 == weights.size() ? std::uint64_t(1) << 32U : first_asking(i + 1, weights.size());
    const double asked = double(next - u) * 0x1p-32;
    found[i] += asked * double(stays) * 0x1p-32;
    found[alias] += asked * (1 - double(stays) * 0x1p-32);
    // Every weight above 0 can be picked, and no other.
    EXPECT_EQ(table.pick(u, 0) == i, weights[i] > 0) << i;
  }
  for (std::size_t i = 0; i < weights.size(); ++i) {
    EXPECT_EQ(stated[i] > 0, weights[i] > 0) << i;
    EXPECT_NEAR(stated[i], found[i], 1e-9 * found[i]) << i;  // an entry that always stays says so to 2^-32
    // The integers are good to one part in 2^32 an entry, and 2^-32 where an entry is asked.
    EXPECT_NEAR(stated[i], weights[i] / table.total(),
                0x1p-31 * (double(weights.size()) * weights[i] / table.total() + 1))
        << i;
  }
  EXPECT_NEAR(std::accumulate(stated.begin(), stated.end(), 0.0), 1, 1e-12);
}

Scene black_ground() {
  Scene scene;
  const int black = add_lambert(scene, Rgb(0, 0, 0));
  add_mesh(scene, make_quad({-50, 0, -50}, {0, 0, 100}, {100, 0, 0}, black));  // looks up
  return scene;
}

// A sun over a scene of 70 m radius is a million times the power of the lamp 3 m above the point: picked by power
// alone the lamp would be found 0.02 times in these samples. Closed form: E = I / h^2.
TEST(Lights, ASunDoesNotStarveALamp) {
  for (const bool sky : {false, true}) {
    Scene scene = black_ground();
    const Rgb lamp(80, 60, 1);  // cd
    scene.lights.push_back(PointLight{V3f(5, 3, 5), lamp});
    if (sky) {
      scene.environment = uniform_environment(Rgb(2e4F, 2e4F, 2e4F));
    } else {
      scene.lights.push_back(DirectionalLight{V3f(0.3F, -1, 0.2F).normalized(), Rgb(1e5F, 1e5F, 1e5F)});
    }
    // Only the lamp shines from above within the shade of a roof that it hangs under.
    add_mesh(scene, make_quad({-20, 6, -20}, {50, 0, 0}, {0, 0, 50}, scene.meshes[0].material));
    for (int side = 0; side < 2; ++side) {
      add_mesh(scene, make_quad({side == 0 ? -20.0F : 30.0F, 0, -20}, {0, 6, 0}, {0, 0, 50}, scene.meshes[0].material));
      add_mesh(scene, make_quad({-20, 0, side == 0 ? -20.0F : 30.0F}, {0, 6, 0}, {50, 0, 0}, scene.meshes[0].material));
    }
    const LitScene lit = make_lit_scene(std::move(scene));
    ProbeParams params;
    params.samples = 20'000;
    const ProbeResult inside = probe_scene(lit, {{V3f(5, 0, 5), V3f(0, 1, 0)}}, params)[0];
    for (int c = 0; c < 3; ++c) {
      const float truth = lamp[c] / 9;
      EXPECT_LT(std::abs(inside.e[c] - truth), float(z_limit) * inside.standard_error[c] + 1e-4F * truth) << c;
      // Picked a quarter of the time: sqrt(3 / 20,000) = 1.2 % of E.
      EXPECT_LT(inside.standard_error[c], 0.02F * truth) << c;
    }
    // Outside the sun still has at least half of the picks: sqrt(1 / 20,000) = 0.7 % and the sky's own noise.
    const ProbeResult outside = probe_scene(lit, {{V3f(-35, 0, -35), V3f(0, 1, 0)}}, params)[0];
    if (!sky) {
      const float truth = 1e5F / std::sqrt(1 + 0.13F);
      EXPECT_LT(std::abs(outside.e.x - truth), float(z_limit) * outside.standard_error.x + 1e-4F * truth);
    }
    EXPECT_LT(outside.standard_error.x, 0.02F * outside.e.x);
  }
}

// A red, a green and a blue lamp of the same power are equally likely, whatever their luminance.
TEST(Lights, ColouredLampsAreEquals) {
  Scene scene;
  const std::vector<V3f> at{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
  for (int c = 0; c < 3; ++c) {
    Rgb intensity(0, 0, 0);
    intensity[c] = 1;
    scene.lights.push_back(PointLight{at[std::size_t(c)], intensity});
  }
  const LitScene lit = in_black_box(std::move(scene));
  RandomStream random = test_stream();
  std::vector<Accumulator> picked(3);
  for (int i = 0; i < 100'000; ++i) {
    const auto s = lit.lights.sample({0, 0, 0}, random);
    for (int c = 0; c < 3; ++c) {
      picked[std::size_t(c)].add(s->w[c] > 0.5F ? 1 : 0);
      if (s->w[c] > 0.5F) {
        ASSERT_NEAR(s->irradiance_weight[c], 3.0F / 4, 1e-5F);
      }
    }
  }
  for (const Accumulator& p : picked) EXPECT_LT(std::abs(z_score(p, 1.0 / 3)), z_limit);
}

// Of two instances the weak one's triangles share an even part: 1/2 * 1 / (1 + 999) + 1/2 * 1/2.
TEST(Lights, InstancesAreGroups) {
  Scene scene;
  const int strong = add_lambert(scene, Rgb(0, 0, 0), Rgb(999, 999, 999));
  const int weak = add_lambert(scene, Rgb(0, 0, 0), Rgb(1, 1, 1));
  add_mesh(scene, make_quad({-1, 3, -1}, {2, 0, 0}, {0, 0, 2}, strong));  // looks down
  add_mesh(scene, make_quad({3, -1, -1}, {0, 0, 2}, {0, 2, 0}, weak));    // looks to -x
  const LitScene lit = in_black_box(std::move(scene));
  RandomStream random = test_stream();
  Accumulator picked;
  for (int i = 0; i < 100'000; ++i) {
    const auto s = lit.lights.sample({0, 0, 0}, random);
    picked.add(s->w.x > std::abs(s->w.y) ? 1 : 0);
  }
  EXPECT_LT(std::abs(z_score(picked, 0.5 / 1000 + 0.25)), z_limit);
}

// Narrower than float's spacing of the cosine below 1, where the cone must not vanish nor the light spread.
TEST(Lights, NarrowSpotsKeepTheirLight) {
  for (const float outer : {1e-2F, 1e-3F, 1e-4F, 1e-5F}) {
    SpotLight spot;
    spot.position = V3f(1, 2, 3);
    spot.direction = V3f(1, -2, 0.5F).normalized();
    spot.intensity_cd = Rgb(1e6F, 1e6F, 1e6F);
    spot.inner_angle_rad = 0;
    spot.outer_angle_rad = outer;
    Scene scene;
    scene.lights.push_back(spot);
    const LitScene lit = in_black_box(std::move(scene));
    // The whole intensity on the axis; the flux is the integral of 2 pi a^2 over the cosine.
    const double cone = 2 * std::pow(std::sin(0.5 * double(outer)), 2);
    const double on_axis = 1e6;
    const Rgb power = lit.lights.total_power_lm();
    EXPECT_NEAR(power.x, 1e6 * 2 * double(pi) * cone / 3, 1e-5 * double(power.x)) << outer;
    RandomStream random = test_stream();
    Accumulator sine2;
    for (int i = 0; i < 20'000; ++i) {
      const V3f w = lit.lights.emit(random).direction;
      const double s = double(w.cross(spot.direction).length());
      // A unit direction's floats are good to 6e-8 in each component.
      ASSERT_LT(s, double(outer) + 3e-7);
      sine2.add(s * s);
    }
    // Mean of sin^2 = 2 x for x = (1 - c) of density 3 (cone - x)^2 / cone^3: cone / 2.
    EXPECT_LT(std::abs(sine2.mean() - cone / 2), z_limit * sine2.standard_error() + 2e-7 * 2e-7 + 2e-3 * cone) << outer;
    const V3f p = spot.position + spot.direction;
    if (outer >= 1e-3F) {
      // At 1 m the point's floats turn its direction by 2e-7 and more: of a cone of 1e-4 rad, too much to compare.
      EXPECT_NEAR(irradiance_samples(lit.lights, p, -spot.direction, 4).mean(), on_axis, 2e-3 * on_axis) << outer;
    }
    const ShadingFrame frame = make_shading_frame(spot.direction);
    EXPECT_FALSE(lit.lights.sample(p + frame.x * (2 * outer + 1e-6F), random)) << outer;
  }
}

Accumulator direct_at(Scene scene, const V3f& p, const V3f& n, int samples) {
  const LitScene lit = make_lit_scene(std::move(scene));
  Surface surface;
  surface.p = p;
  surface.ng = surface.ns = n;
  surface.diffuse_albedo = Rgb(1, 1, 1);
  surface.specular_f90 = Rgb(0, 0, 0);  // Lambertian
  surface.reach_m = triangle_reach_m(*lit.scene, 0, 0);
  const Bsdf bsdf = make_bsdf(surface);
  return collect(samples, [&](RandomStream& random) {
    return sample_direct(lit, surface, bsdf, n, DirectStrategy::light, random) * pi;
  });
}

// A plate 1 mm in front of a lamp 100 m away, and of an emitter there: both hide it. Behind it, they do not.
TEST(ShadowEnds, BlockersCloseToALampBlock) {
  for (const bool emitter : {false, true}) {
    for (const float plate_m : {-0.001F, 0.001F}) {  // below, above
      Scene scene;
      const int black = add_lambert(scene, Rgb(0, 0, 0), Rgb(0, 0, 0), true);
      add_mesh(scene, make_quad({-2, 100 + plate_m, -2}, {4, 0, 0}, {0, 0, 4}, black));
      if (emitter) {
        const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(1e4F, 1e4F, 1e4F));
        add_mesh(scene, make_quad({-0.5F, 100, -0.5F}, {1, 0, 0}, {0, 0, 1}, lamp));  // looks down
      } else {
        scene.lights.push_back(PointLight{V3f(0, 100, 0), Rgb(1e4F, 1e4F, 1e4F)});
      }
      const Accumulator e = direct_at(std::move(scene), V3f(0, 0, 0), V3f(0, 1, 0), 1000);
      if (plate_m < 0) {
        EXPECT_EQ(e.mean(), 0) << emitter;
      } else {
        EXPECT_NEAR(e.mean(), 1.0, 1e-3) << emitter;  // L A / r^2, less 1e-4 for the square's size
      }
    }
  }
}

// A square emitter of half side a at height h over the point, by sampling lights alone: E between parallel planes is
// 4 L (a / r) atan(a / r) with r^2 = a^2 + h^2.
TEST(ShadowEnds, EmittersCloseByLightFarFromTheOrigin) {
  // Leaning: coordinates along the axes would round to the very plane of the lamp.
  const V3f n = V3f(0.4F, 1, -0.3F).normalized();
  const ShadingFrame frame = make_shading_frame(n);
  for (const float far_m : {0.0F, 10.0F, 100.0F, 1000.0F}) {
    for (const float height_m : {0.3F, 0.03F, 0.01F}) {
      const V3f p(far_m, far_m, -far_m);
      Scene scene;
      const int black = add_lambert(scene, Rgb(0, 0, 0));
      const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(5, 5, 5));
      add_mesh(scene, make_quad(p - (frame.x + frame.y) * 2, frame.x * 4, frame.y * 4, black));  // looks along n
      const V3f corner = p + (n - frame.x - frame.y) * height_m;
      add_mesh(scene, make_quad(corner, frame.y * (2 * height_m), frame.x * (2 * height_m), lamp));  // against n
      const double truth = 4 * 5 * std::sqrt(0.5) * std::atan(std::sqrt(0.5));
      const Accumulator e = direct_at(std::move(scene), p, n, 20'000);
      // Coordinates at 1 km are 6e-5 m apart: each of the lamp's sides and its height may be off by half of
      // that, and E goes as their ratio's square.
      const double rounding = (1e-4 + 4 * 0x1p-24 * double(far_m) / double(height_m)) * truth;
      EXPECT_LT(std::abs(e.mean() - truth), z_limit * e.standard_error() + rounding) << far_m << " " << height_m;
    }
  }
}

}  // namespace
}  // namespace ivory
