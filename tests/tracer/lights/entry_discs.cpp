// Photons of suns and skies that are sent at a small part of a large scene: their density, their flux and where they
// start.
#include "tracer/lights/entry_discs.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/lights_check.h"

namespace ivory {
namespace {

constexpr float scene_radius_m = 1000;
const BoundingSphere scene_sphere{V3f(100, -20, 50), scene_radius_m};
const Box3f scene_box(V3f(-500, -25, -500), V3f(700, -5, 650));
const V3f w_from = V3f(0.5F, 0.7F, -0.3F).normalized();

// Mean area that stands for a photon through a small disc at that distance from the target, over the disc's own: 1.
Accumulator seen_at(const EntryDiscs& discs, const V3f& at, double radius_m, int count) {
  const ShadingFrame frame = make_shading_frame(w_from);
  RandomStream random = test_stream(3);
  Accumulator mean;
  for (int i = 0; i < count; ++i) {
    const Entry entry = sample(discs, w_from, frame, random);
    const V3d to = V3d(entry.origin) - V3d(at);
    const double off = (to - V3d(w_from) * to.dot(V3d(w_from))).length();
    mean.add(off < radius_m ? double(entry.area_m2) / (double(pi) * radius_m * radius_m) : 0);
  }
  return mean;
}

TEST(EntryDiscs, BringTheSameFluxEverywhere) {
  const EmissionTarget target{V3f(400, -20, -300), 5, false};
  const EntryDiscs discs = make_entry_discs(scene_sphere, scene_box, target);
  ASSERT_EQ(discs.radii_m, (std::vector<double>{5, 20, 80, 320}));
  const ShadingFrame frame = make_shading_frame(w_from);
  // On the target, at rims of discs, in the last disc and in the scene's alone; a seventh of the distance wide.
  for (const float away_m : {0.0F, 4.9F, 21.0F, 100.0F, 300.0F, 400.0F}) {
    const Accumulator flux = seen_at(discs, target.center + frame.x * away_m, 1 + double(away_m) / 7, 200'000);
    EXPECT_LT(std::abs(z_score(flux, 1)), z_limit) << away_m;
    // Of 200,000 photons, at least 1/10 through each disc, and each disc is four times as wide as the last.
    EXPECT_LT(flux.standard_error(), 0.25) << away_m;
  }
  // And as much in all as the scene's disc alone.
  RandomStream random = test_stream();
  Accumulator area;
  for (int i = 0; i < 100'000; ++i) area.add(double(sample(discs, w_from, frame, random).area_m2));
  EXPECT_LT(std::abs(z_score(area, double(pi) * 1e6)), z_limit);
  // The target gets 0.35 + 0.35 / 16 + 0.1 / 256 ... of the photons, not one in 40,000.
  EXPECT_NEAR(double(near_area_m2(discs)), double(pi) * 25 / 0.3723, 0.1);
}

// Ahead of all surfaces and of the target, and no farther from them than it must be.
TEST(EntryDiscs, StartAheadOfEverything) {
  for (const V3f& center : {V3f(400, -20, -300), V3f(100, 900, 50), V3f(5000, 0, 0)}) {
    const EmissionTarget target{center, 5, true};
    const EntryDiscs discs = make_entry_discs(scene_sphere, scene_box, target);
    RandomStream random = test_stream();
    for (int i = 0; i < 2000; ++i) {
      const V3f w = sample_sphere(random.next2());
      const V3f origin = sample(discs, w, make_shading_frame(w), random).origin;
      // The rest of the ray, the way that it came from, meets neither.
      const float along = (center - origin).dot(w);
      EXPECT_LT(along, -4.99F);
      float enter = 0;
      float leave = std::numeric_limits<float>::infinity();
      for (unsigned axis = 0; axis < 3; ++axis) {
        const float a = (scene_box.min[axis] - origin[axis]) / w[axis];
        const float b = (scene_box.max[axis] - origin[axis]) / w[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      EXPECT_LT(leave, enter) << w << " " << origin;
    }
  }
  // Straight down onto flat ground: from just above it.
  const EntryDiscs discs = make_entry_discs(scene_sphere, scene_box, EmissionTarget{V3f(400, -20, -300), 5, false});
  RandomStream random = test_stream();
  for (int i = 0; i < 100; ++i)
    EXPECT_LT(sample(discs, V3f(0, 1, 0), make_shading_frame(V3f(0, 1, 0)), random).origin.y, -4.8F);
}

TEST(EntryDiscs, AreOneUnlessAPartIsAskedFor) {
  const auto count = [](const V3f& center, float radius_m, bool direct) {
    return make_entry_discs(scene_sphere, scene_box, EmissionTarget{center, radius_m, direct}).radii_m.size();
  };
  EXPECT_EQ(make_entry_discs(scene_sphere, scene_box, std::nullopt).radii_m.size(), 0);
  EXPECT_EQ(count(scene_sphere.center, 900, false), 0);
  EXPECT_EQ(count(scene_sphere.center, 900, true), 0);
  EXPECT_EQ(count(scene_sphere.center, 501, true), 0);
  EXPECT_EQ(count(scene_sphere.center, 500, false), 1);
  // Beyond the scene's sphere there is direct light alone.
  EXPECT_EQ(count(V3f(600, 0, 0), 900, false), 0);
  EXPECT_EQ(count(V3f(600, 0, 0), 900, true), 1);
}

Scene sun_sky_and_lamp() {
  Scene scene;
  const int black = add_lambert(scene, Rgb(0, 0, 0));
  add_mesh(scene, make_quad({-500, 0, -500}, {0, 0, 1000}, {1000, 0, 0}, black));
  scene.lights.push_back(DirectionalLight{-w_from, Rgb(3, 3, 3)});
  scene.lights.push_back(point_at({0, 3, 0}, {100, 100, 100}));
  scene.environment = uniform_environment({1, 1, 1});
  return scene;
}

TEST(Emission, ATargetAsLargeAsTheSceneChangesNoPhoton) {
  const LitScene lit = make_lit_scene(sun_sky_and_lamp());
  const Lights::Emission emission = lit.lights.emission(EmissionTarget{V3f(0, 0, 0), 600, false});
  RandomStream a = test_stream();
  RandomStream b = test_stream();
  for (int i = 0; i < 1000; ++i) {
    const EmittedPhoton one = lit.lights.emit(a);
    const EmittedPhoton other = lit.lights.emit(emission, b);
    ASSERT_EQ(one.origin, other.origin);
    ASSERT_EQ(one.direction, other.direction);
    ASSERT_EQ(one.power, other.power);
  }
}

TEST(Emission, PhotonsForATargetKeepThePowerAndStayInTheirRange) {
  const LitScene lit = make_lit_scene(sun_sky_and_lamp());
  const Lights::Emission emission = lit.lights.emission(EmissionTarget{V3f(20, 2, 0), 2, false});
  const Lights::PhotonPower range = emission.photon_power();
  RandomStream random = test_stream();
  Accumulator power;
  float most = 0;
  float least = std::numeric_limits<float>::infinity();
  int lamp = 0;
  for (int i = 0; i < 100'000; ++i) {
    const EmittedPhoton photon = lit.lights.emit(emission, random);
    power.add(double(photon.power.x));
    most = std::max(most, photon.power.x);
    if (photon.power.x > 0) least = std::min(least, photon.power.x);
    lamp += photon.origin == V3f(0, 3, 0) ? 1 : 0;
  }
  EXPECT_LT(std::abs(z_score(power, double(lit.lights.total_power_lm().x))), z_limit);
  EXPECT_NEAR(least, range.weakest_lm, 1e-3F * range.weakest_lm);
  EXPECT_LT(most, 1.001F * range.heaviest_lm);
  EXPECT_GT(most, 0.99F * range.heaviest_lm);
  EXPECT_GT(range.heaviest_lm, 1000 * range.strongest_lm);
  // 1,257 lm beside 101 and 424 through the target: half of the photons and more, where by power over the whole scene
  // it would be a sixth.
  EXPECT_GT(lamp, 50'000);
}

}  // namespace
}  // namespace ivory
