// Eye rays pass through the back faces of single-sided materials; all other rays meet both sides.
#include <optional>

#include <gtest/gtest.h>

#include "tools/stability/scene_builder.h"
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

}  // namespace
}  // namespace ivory
