// Spherical lights as meshes.
#include "tracer/lights/sphere.h"

#include <cmath>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/statistics.h"
#include "tools/stability/scene_builder.h"
#include "tracer/render/path_tracer.h"

namespace ivory {
namespace {

TEST(SphereLight, PathTracerSeesASphere) {
  for (const V3f& at : {V3f(0, 0, 0), V3f(1000, -500, 20)}) {
    Scene scene;
    add_mesh(scene, make_quad(at + V3f(-1, 0, 1), {2, 0, 0}, {0, 0, -2}, add_lambert(scene, Rgb(1, 1, 1))));
    add_sphere_light(scene, {at + V3f(0.5F, 2, 0), 0.5F, Rgb(3, 3, 3)}, "test");
    const LitScene lit = make_lit_scene(std::move(scene));
    Ray ray;
    ray.origin = at + V3f(0, 0.5F, 0.3F);
    ray.direction = V3f(0, -0.5F, -0.3F).normalized();
    PathParams direct;
    direct.max_bounces = 1;
    RandomStream random(5, StreamPurpose::test, 1);
    Accumulator path;
    for (int i = 0; i < 40000; ++i) path.add(double(trace_path(lit, ray, direct, random).y));
    const double d2 = 4.25;
    const double expected = 3 * 0.25 / d2 * 2 / std::sqrt(d2);
    EXPECT_LT(std::abs(path.mean() - expected), z_limit * path.standard_error() + 1e-3 * expected);
  }
}

TEST(SphereLight, RefusesWhatIsNoSphere) {
  Scene scene;
  EXPECT_THROW(add_sphere_light(scene, {V3f(0, 0, 0), 0, Rgb(1, 1, 1)}, "t"), Error);
  EXPECT_THROW(add_sphere_light(scene, {V3f(0, 0, 0), -1, Rgb(1, 1, 1)}, "t"), Error);
  EXPECT_THROW(add_sphere_light(scene, {V3f(0, NAN, 0), 1, Rgb(1, 1, 1)}, "t"), Error);
  EXPECT_THROW(add_sphere_light(scene, {V3f(0, 0, 0), 1, Rgb(1, -1, 1)}, "t"), Error);
  EXPECT_THROW(add_sphere_light(scene, {V3f(1e8F, 0, 0), 1, Rgb(1, 1, 1)}, "t"), Error);
  EXPECT_TRUE(scene.instances.empty());
}

}  // namespace
}  // namespace ivory
