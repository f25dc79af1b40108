// Surfaces of plain materials against make_surface(), and the photon's way on from them.
#include "tracer/core/plain_surfaces.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "grid/base/circle.h"
#include "tests/support/paths.h"
#include "tests/support/statistics.h"
#include "tracer/core/sampler.h"
#include "tracer/gltf/loader.h"
#include "tracer/render/photons/lambert.h"

namespace ivory {
namespace {

// Every member but emission, at random hits of bundled scenes: flat boxes, smooth balls, placed copies, textures.
TEST(PlainSurfaces, AreThoseOfMakeSurface) {
  int plain = 0;
  int flat = 0;
  int smooth = 0;
  int other = 0;
  for (const std::string name : {"two_rooms.gltf", "crowd.glb", "integrating_sphere.glb", "knot.glb", "plaza.gltf"}) {
    const Scene scene = load_gltf(std::string(source_folder) + "/scenes/" + name).scene;
    const Intersector intersector(scene);
    const PlainSurfaces surfaces(scene);
    RandomStream random(1, StreamPurpose::test, 0);
    for (int i = 0; i < 4000; ++i) {
      Ray ray;
      ray.origin = intersector.center() + sample_sphere(random.next2()) * (intersector.radius_m() * random.next());
      ray.direction = sample_sphere(random.next2());
      const std::optional<Hit> hit = intersector.closest(ray);
      if (!hit) continue;
      const Surface truth = make_surface(scene, ray, *hit);
      const Surface fast = surfaces.make_scattering(ray, *hit);
      ASSERT_EQ(fast.p, truth.p) << name;
      ASSERT_EQ(fast.ng, truth.ng) << name;
      ASSERT_EQ(fast.front, truth.front) << name;
      ASSERT_EQ(fast.reach_m, truth.reach_m) << name;
      ASSERT_EQ(fast.diffuse_albedo, truth.diffuse_albedo) << name;
      ASSERT_EQ(fast.specular_f0, truth.specular_f0) << name;
      ASSERT_EQ(fast.specular_f90, truth.specular_f90) << name;
      ASSERT_EQ(fast.roughness_alpha, truth.roughness_alpha) << name;
      const PlainInstance& instance = surfaces.instance(hit->instance);
      if (instance.mesh != nullptr && instance.is_flat(hit->triangle)) {
        // Of normals 1e-4 apart; what is bent to face the ray, at grazing angles, may turn by 0.01.
        const float limit = std::abs(ray.direction.dot(truth.ng)) < 0.02F ? 0.02F : 2e-4F;
        ASSERT_LT((fast.ns - truth.ns).length(), limit) << name;
        ++flat;
      } else {
        ASSERT_EQ(fast.ns, truth.ns) << name;
        ++(instance.mesh != nullptr ? smooth : other);
      }
      plain += instance.mesh != nullptr ? 1 : 0;
    }
  }
  EXPECT_GT(plain, 5000);
  EXPECT_GT(flat, 1000) << "nothing was tested";
  EXPECT_GT(smooth, 1000) << "nothing was tested";
  RecordProperty("with_textures_or_colours", other);
}

TEST(PlainSurfaces, TheCircleInFloatIsTheCircle) {
  for (int i = 0; i < 100'000; ++i) {
    const float turns = float(i) / 100'000;
    const Imath::V2d truth = on_unit_circle(double(turns));
    const V2f fast = on_unit_circle_float(turns);
    // Roundings of numbers up to 1, a handful of 6e-8, and 3e-8 of the sums' first term left out.
    ASSERT_NEAR(double(fast.x), truth.x, 2.5e-7) << turns;
    ASSERT_NEAR(double(fast.y), truth.y, 2.5e-7) << turns;
  }
  EXPECT_NEAR(double(on_unit_circle_float(0x1.fffffep-1F).x), 1, 2.5e-7);  // the largest below 1
}

// Moments of cos/pi around n: mean of the cosine 2/3 and of its square 1/2, of both directions across 0, each within
// four standard errors: a false alarm once in 15,800 for each of 5 x 4.
TEST(PlainSurfaces, PhotonsGoOnByTheCosine) {
  for (const V3f& axis : {V3f(0, 0, 1), V3f(0, 0, -1), V3f(1, 0, 0), V3f(-0.3F, 0.5F, -0.8F), V3f(0.2F, -1, 1e-4F)}) {
    const V3f n = axis.normalized();
    const ShadingFrame frame = make_shading_frame(n);
    RandomStream random(2, StreamPurpose::test, 0);
    Accumulator cosine;
    Accumulator square;
    Accumulator x;
    Accumulator y;
    for (int i = 0; i < 100'000; ++i) {
      const V3f w = cosine_direction(n, random.next2());
      ASSERT_NEAR(double(w.length()), 1, 1e-6);
      ASSERT_GT(w.dot(n), 0);
      cosine.add(double(w.dot(n)));
      square.add(double(w.dot(n)) * double(w.dot(n)));
      x.add(double(w.dot(frame.x)));
      y.add(double(w.dot(frame.y)));
    }
    EXPECT_LT(std::abs(z_score(cosine, 2.0 / 3)), z_limit);
    EXPECT_LT(std::abs(z_score(square, 0.5)), z_limit);
    EXPECT_LT(std::abs(x.mean() / x.standard_error()), z_limit);
    EXPECT_LT(std::abs(y.mean() / y.standard_error()), z_limit);
  }
}

}  // namespace
}  // namespace ivory
