// Eye rays pass through the back faces of single-sided materials; all other rays meet both sides.
#include <limits>
#include <optional>
#include <utility>

#include <gtest/gtest.h>

#include "tools/stability/scene_builder.h"
#include "tracer/core/camera.h"
#include "tracer/core/intersector.h"

namespace ivory {
namespace {

// Embree divides by a reciprocal whose last bits depend on the instruction set: 2 may come out as 1.99999988.
constexpr float rounding = 1e-6F;

// The closest hit's distance from z = +-2 towards the origin, or nothing.
std::optional<float> meet(const Intersector& intersector, float x, float from_z, bool eye) {
  Ray ray;
  ray.origin = {x, 0, from_z};
  ray.direction = {0, 0, from_z > 0 ? -1.0F : 1.0F};
  ray.cull_back_faces = eye;
  const std::optional<Hit> hit = intersector.closest(ray);
  return hit ? std::optional(hit->t) : std::nullopt;
}

// A quad at z = 0 around (x, 0), its front towards +Z.
Mesh quad_at(float x, int material) { return make_quad({x - 0.5F, -0.5F, 0}, {1, 0, 0}, {0, 1, 0}, material); }

TEST(EyeRays, PassBackFacesOfSingleSidedMaterials) {
  Scene scene;
  add_mesh(scene, quad_at(0, add_lambert(scene, Rgb(0.5F))));
  add_mesh(scene, quad_at(2, add_lambert(scene, Rgb(0.5F), Rgb(0, 0, 0), true)));
  const Intersector intersector(scene);
  EXPECT_NEAR(meet(intersector, 0, 2, true).value_or(0), 2, rounding);
  EXPECT_EQ(meet(intersector, 0, -2, true), std::nullopt);
  EXPECT_NEAR(meet(intersector, 0, -2, false).value_or(0), 2, rounding);
  EXPECT_NEAR(meet(intersector, 2, -2, true).value_or(0), 2, rounding) << "double-sided";
}

// A mirroring node reverses the winding (glTF 2.0, 3.7.4): a mirror along X keeps the front where it was,
// one along Z turns it round, whether the mesh is placed once or, instanced, several times.
TEST(EyeRays, KnowTheFrontOfMirroredNodes) {
  const M44f mirror_x(-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
  const M44f mirror_z(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 4, 0, 0, 1);
  for (const bool instanced : {false, true}) {
    Scene scene;
    const int material = add_lambert(scene, Rgb(0.5F));
    const int mesh = add_mesh(scene, quad_at(0, material), mirror_x);
    if (instanced) {
      scene.instances.push_back({mesh, mirror_z});
    } else {
      add_mesh(scene, quad_at(0, material), mirror_z);
    }
    const Intersector intersector(scene);
    EXPECT_NEAR(meet(intersector, 0, 2, true).value_or(0), 2, rounding) << instanced;
    EXPECT_EQ(meet(intersector, 0, -2, true), std::nullopt) << instanced;
    EXPECT_EQ(meet(intersector, 4, 2, true), std::nullopt) << instanced;
    EXPECT_NEAR(meet(intersector, 4, -2, true).value_or(0), 2, rounding) << instanced;
  }
}

// Planes across the direction of view, not spheres: a near plane 1.5 m away hides a square at 1 m to its corners and
// shows one at 2 m, where the far plane at 2.5 m lets it.
TEST(EyeRays, StartAtTheNearPlaneAndEndAtTheFarOne) {
  Scene scene;
  const int material = add_lambert(scene, Rgb(0.5F));
  const auto wall = [&](float z) { return make_quad({-5, -5, z}, {10, 0, 0}, {0, 10, 0}, material); };
  for (const float z : {-1.0F, -2.0F, -3.0F}) add_mesh(scene, wall(z));
  const Intersector intersector(scene);
  for (const bool perspective : {true, false}) {
    Camera camera;
    camera.perspective = perspective;
    camera.yfov_rad = 1.5F;
    const auto depth = [&](float near_m, float far_m, const V2f& pixel) {
      camera.near_m = near_m;
      camera.far_m = far_m;
      const View view = make_view("test", camera, 16, 16);
      const Ray ray = make_ray(view, pixel);
      const std::optional<Hit> hit = intersector.closest(ray);
      return hit ? hit->t * ray.direction.dot(view.forward) : 0.0F;
    };
    const float infinite = std::numeric_limits<float>::infinity();
    for (const V2f& pixel : {V2f(8, 8), V2f(0.1F, 0.1F), V2f(15.9F, 3)}) {
      EXPECT_NEAR(depth(0, infinite, pixel), 1, 1e-5F);
      EXPECT_NEAR(depth(0.99F, 10, pixel), 1, 1e-5F);
      EXPECT_NEAR(depth(1.5F, 2.5F, pixel), 2, 1e-5F);
      EXPECT_NEAR(depth(2.5F, infinite, pixel), 3, 1e-5F);
      EXPECT_EQ(depth(2.1F, 2.9F, pixel), 0);
      EXPECT_EQ(depth(0, 0.9F, pixel), 0);
    }
  }
}

// A room whose walls are 0.4 m thick, as two boxes: fronts outside and, of the inner one, inwards.
TEST(EyeRays, AnEyeInsideAWallIsDoubted) {
  for (const bool double_sided : {false, true}) {
    Scene scene;
    const int material = add_lambert(scene, Rgb(0.5F), Rgb(0, 0, 0), double_sided);
    add_mesh(scene, make_room(V3f(-2, -2, -2), V3f(2, 2, 2), material));
    Mesh outside = make_room(V3f(-2.4F, -2.4F, -2.4F), V3f(2.4F, 2.4F, 2.4F), material);
    for (auto& t : outside.triangles) std::swap(t.y, t.z);
    for (V3f& n : outside.normals) n = -n;
    add_mesh(scene, outside);
    const Intersector intersector(scene);
    const auto doubt = [&](const V3f& eye, float near_m) {
      Camera camera;
      camera.to_world.setTranslation(eye);
      camera.near_m = near_m;
      return doubt_about(intersector, make_view("test", camera, 16, 12), "eye").has_value();
    };
    EXPECT_EQ(doubt(V3f(0, 0, 2.2F), 0), !double_sided) << "its backs are seen where they are double-sided";
    EXPECT_FALSE(doubt(V3f(0, 0, 2.2F), 0.5F)) << "the near plane cuts the wall away";
    EXPECT_FALSE(doubt(V3f(0, 0, 0), 0));
    EXPECT_FALSE(doubt(V3f(0, 0, 6), 0));
    EXPECT_GT(look_around(intersector, V3f(0, 0, 2.2F)).back_share, 0.99);
    EXPECT_LT(look_around(intersector, V3f(0, 0, 0)).back_share, 0.01);
  }
}

}  // namespace
}  // namespace ivory
