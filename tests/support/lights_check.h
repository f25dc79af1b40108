// What every light must hold to: its power is that of its photons.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"
#include "tools/stability/scene_builder.h"
#include "tracer/core/lit_scene.h"

namespace ivory {

inline RandomStream test_stream(std::uint64_t index = 0) { return {1, StreamPurpose::test, index}; }

// A black box gives a scene of lights alone a bounding sphere.
inline LitScene in_black_box(Scene scene) {
  if (scene.instances.empty()) {
    const int black = add_lambert(scene, Rgb(0, 0, 0));
    add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), black));
  }
  return make_lit_scene(std::move(scene));
}

// E(p, n) by sampling lights, without occlusion.
inline Accumulator irradiance_samples(const Lights& lights, const V3f& p, const V3f& n, int count) {
  RandomStream random = test_stream();
  Accumulator e;
  for (int i = 0; i < count; ++i) {
    const auto s = lights.sample(p, random);
    e.add(s ? double(s->irradiance_weight.x * std::max(0.0F, s->w.dot(n))) : 0.0);
  }
  return e;
}

inline void expect_power_and_photons_agree(const Lights& lights, const Rgb& power_lm, const std::string& label) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(lights.total_power_lm()[c], power_lm[c], 1e-5F * power_lm[c]) << label;  // float rounding
  RandomStream random = test_stream();
  Accumulator mean;
  for (int i = 0; i < 100000; ++i) {
    const EmittedPhoton photon = lights.emit(random);
    ASSERT_NEAR(photon.direction.length(), 1, 1e-5F);
    mean.add(double(photon.power.x));
  }
  EXPECT_LT(std::abs(z_score(mean, double(power_lm.x))), z_limit) << label;
}

inline PointLight point_at(const V3f& p, const Rgb& intensity) { return {p, intensity}; }

inline Scene lamp_scene(bool double_sided, const M44f& to_world = M44f()) {
  Scene scene;
  const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(10, 5, 1), double_sided);
  add_mesh(scene, make_quad({0, 2, 0}, {1, 0, 0}, {0, 0, 3}, lamp), to_world);  // front looks down
  return scene;
}

}  // namespace ivory
