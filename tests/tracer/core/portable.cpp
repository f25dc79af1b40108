// Hits in arithmetic of ivory's own: Embree's to within rounding, and no gap between triangles.
#include <random>

#include <gtest/gtest.h>

#include "tools/stability/scene_builder.h"
#include "tracer/core/intersector.h"
#include "tracer/core/rays/crossing.h"
#include "tracer/core/sampling.h"

namespace ivory {
namespace {

V3f random_point(std::mt19937& random, float half) {
  std::uniform_real_distribution<float> u(-half, half);
  return {u(random), u(random), u(random)};
}
V3f random_direction(std::mt19937& random) {
  std::uniform_real_distribution<float> u(0, 1);
  return sample_sphere({u(random), u(random)}).normalized();
}

TEST(Crossing, FindsThePointThatWasAimedAt) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> weight(0, 1);
  for (int i = 0; i < 20000; ++i) {
    const std::array<V3f, 3> corners{random_point(random, 3), random_point(random, 3), random_point(random, 3)};
    V2f b(weight(random), weight(random));
    if (b.x + b.y > 1) b = V2f(1, 1) - b;
    const V3f target = corners[0] * (1 - b.x - b.y) + corners[1] * b.x + corners[2] * b.y;
    const V3f origin = random_point(random, 5);
    const float area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
    const V3f d = target - origin;
    // Nearly edge on, and near the edges, the rounding of the target decides.
    const float across = std::abs((corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(d)) / d.length();
    if (across < 0.05F || area < 0.05F || std::min({b.x, b.y, 1 - b.x - b.y}) < 1e-3F) continue;
    const auto met = crossing(make_line(origin, d), corners);
    ASSERT_TRUE(met) << i;
    // The target is rounded to 2^-23 of 3 m; seen at a slope of 0.05 that is 1e-5 of weight.
    EXPECT_NEAR(met->t, 1, 2e-5);
    EXPECT_NEAR(met->u, b.x, 2e-4);
    EXPECT_NEAR(met->v, b.y, 2e-4);
  }
}

TEST(Crossing, PassesNothingOutsideInThePlaneOrWithoutArea) {
  const std::array<V3f, 3> corners{V3f(0, 0, 0), V3f(1, 0, 0), V3f(0, 1, 0)};
  EXPECT_FALSE(crossing(make_line({0.6F, 0.6F, 1}, {0, 0, -1}), corners));
  EXPECT_FALSE(crossing(make_line({-1, 0.25F, 0}, {1, 0, 0}), corners));
  EXPECT_FALSE(crossing(make_line({0.5F, 0, 1}, {0, 0, -1}), {V3f(0, 0, 0), V3f(1, 0, 0), V3f(2, 0, 0)}));
  EXPECT_TRUE(crossing(make_line({0.5F, 0, 1}, {0, 0, -1}), corners));  // its edges are its own
  EXPECT_TRUE(crossing(make_line({0, 0, 1}, {0, 0, -1}), corners));     // and its corners
}

// A fan of triangles around a corner, met at its corner and along its spokes, from afar and at a slant.
TEST(Crossing, LeavesNoGapBetweenNeighbours) {
  std::mt19937 random(12);
  std::uniform_real_distribution<float> u(0, 1);
  int gaps = 0;
  for (int i = 0; i < 20000; ++i) {
    constexpr int blades = 5;
    const V3f hub = random_point(random, 100);
    std::array<V3f, blades> rim;
    for (int k = 0; k < blades; ++k) {
      const float angle = 2 * pi * float(k) / blades;
      rim[std::size_t(k)] = hub + V3f(std::cos(angle), std::sin(angle), 0.2F * u(random));
    }
    const V3f& spoke = rim[std::size_t(i % blades)];
    const V3f target = i % 3 == 0 ? hub : hub + (spoke - hub) * (0.9F * u(random));
    const V3f origin = hub + V3f(u(random) - 0.5F, u(random) - 0.5F, 1) * (1 + 1000 * u(random));
    const Line line = make_line(origin, target - origin);
    bool met = false;
    for (int k = 0; k < blades; ++k) {
      // Every other triangle is wound the other way.
      const V3f& p = rim[std::size_t(k)];
      const V3f& q = rim[std::size_t((k + 1) % blades)];
      const std::array<V3f, 3> corners = k % 2 == 0 ? std::array{hub, p, q} : std::array{q, p, hub};
      met = met || crossing(line, corners).has_value();
    }
    gaps += met ? 0 : 1;
  }
  EXPECT_EQ(gaps, 0);
}

// A room with boxes placed once and many times, mirrored, squeezed and far off; a thin pane; single sides.
Scene clutter() {
  Scene scene = small_room();
  scene.materials[0].double_sided = false;
  Mesh wedge = make_quad({-0.1F, 0, 0}, {0.2F, 0.05F, 0}, {0, 0.2F, 0.1F}, 0);
  wedge.triangles.pop_back();
  const int shared = add_mesh(scene, wedge);
  std::mt19937 random(13);
  for (int i = 0; i < 60; ++i) {
    M44f m;
    m.rotate(random_point(random, 3));
    m.scale(V3f(i % 3 == 0 ? -1.0F : 1.0F, 1.5F, 0.3F));
    m *= M44f().setTranslation(random_point(random, 0.8F));
    scene.instances.push_back({shared, m});
  }
  return scene;
}

TEST(PortableIntersector, MeetsWhatEmbreeMeets) {
  const Scene scene = clutter();
  const Intersector embree(scene);
  const Intersector portable(scene, {true});
  std::mt19937 random(14);
  constexpr int rays = 100000;
  int other = 0;
  for (int i = 0; i < rays; ++i) {
    Ray ray;
    ray.origin = random_point(random, 0.95F);
    ray.direction = random_direction(random);
    ray.cull_back_faces = i % 2 == 0;
    const auto a = embree.closest(ray);
    const auto b = portable.closest(ray);
    ASSERT_EQ(a.has_value(), b.has_value()) << i;
    if (!a) continue;
    if (a->instance != b->instance || a->triangle != b->triangle) {
      ++other;
      continue;
    }
    // Embree's own error: 2^-22 of coordinates of 1 m, more at grazing incidence.
    EXPECT_NEAR(a->t, b->t, 1e-5 / std::max(0.02F, std::abs(a->ng.dot(ray.direction))));
    EXPECT_LT((a->ng - b->ng).length(), 1e-5F);
    ray.t_max = 0.999F * b->t;
    EXPECT_EQ(portable.transmittance(ray), ray.cull_back_faces ? embree.transmittance(ray) : 1.0F);
    ray.t_max = 1.001F * b->t;
    EXPECT_EQ(portable.transmittance(ray), embree.transmittance(ray));
  }
  // Within rounding of an edge, 1e-6 of the triangles' size or so: a ray in ten thousand at most.
  EXPECT_LE(other, rays / 10000);
}

TEST(PortableIntersector, AnswersEightAtOnceAsOneByOne) {
  const Scene scene = clutter();
  const Intersector portable(scene, {true});
  std::mt19937 random(15);
  for (int i = 0; i < 2000; ++i) {
    const int count = 1 + i % 8;
    const V3f direction = random_direction(random);
    std::array<V3f, 8> points;
    for (V3f& p : points) p = random_point(random, 0.9F);
    const auto distances = portable.distances(points, count, direction);
    const std::uint32_t visible = portable.visible(points[7], points, count);
    for (int k = 0; k < count; ++k) {
      Ray ray;
      ray.origin = points[std::size_t(k)];
      ray.direction = direction;
      const auto hit = portable.closest(ray);
      EXPECT_EQ(distances[std::size_t(k)], hit ? hit->t : std::numeric_limits<float>::infinity());
      ray.origin = points[7];
      ray.direction = points[std::size_t(k)] - points[7];
      ray.t_max = 1;
      EXPECT_EQ((visible >> unsigned(k)) & 1U, portable.transmittance(ray) > 0 ? 1U : 0U);
    }
  }
}

// Two panes at one place: the first by number, wherever the ray comes from.
TEST(PortableIntersector, TakesTheFirstOfSurfacesAtOnePlace) {
  Scene scene;
  const int white = add_lambert(scene, Rgb(0.5F));
  for (int k = 0; k < 9; ++k) add_mesh(scene, make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, white));
  const Intersector portable(scene, {true});
  std::mt19937 random(16);
  for (int i = 0; i < 2000; ++i) {
    Ray ray;
    ray.origin = random_point(random, 0.9F) + V3f(0, 0, i % 2 == 0 ? 2.0F : -2.0F);
    ray.direction = (random_point(random, 0.9F) * V3f(1, 1, 0) - ray.origin).normalized();
    const auto hit = portable.closest(ray);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->instance, 0);
  }
}

}  // namespace
}  // namespace ivory
