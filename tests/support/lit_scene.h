// Scenes to trace in, and many independent estimates of one ray's light.
#pragma once

#include <functional>

#include "tests/support/statistics.h"
#include "tools/stability/scene_builder.h"
#include "tracer/render/path_tracer.h"
#include "tracer/render/render.h"

namespace ivory {

inline Ray ray_to(const V3f& origin, const V3f& target) {
  Ray ray;
  ray.origin = origin;
  ray.direction = (target - origin).normalized();
  return ray;
}

using Estimate = std::function<Rgb(RandomStream&)>;

// Green channel of `count` independent estimates.
inline Accumulator collect(int count, const Estimate& estimate, std::uint64_t stream = 0) {
  RandomStream random(11, StreamPurpose::test, stream);
  Accumulator samples;
  for (int i = 0; i < count; ++i) samples.add(double(estimate(random).y));
  return samples;
}

inline Accumulator path_samples(const LitScene& lit, const Ray& ray, const PathParams& params, int count,
                                std::uint64_t stream = 0) {
  return collect(
      count, [&](RandomStream& random) { return trace_path(lit, ray, params, random); }, stream);
}

inline Scene furnace(float albedo, const Rgb& emission) {
  Scene scene;
  const int wall = add_lambert(scene, Rgb(albedo, albedo, albedo), emission);
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), wall));
  return scene;
}

inline View test_view(int width, int height) {
  Camera camera;
  camera.to_world[3][1] = 0.2F;
  camera.to_world[3][2] = 0.9F;
  camera.yfov_rad = 1.2F;
  return make_view("test", camera, width, height);
}

}  // namespace ivory
