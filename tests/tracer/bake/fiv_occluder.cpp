// The occluder that a table is baked from, and finding it again in a scene.
#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tools/stability/fiv_shapes.h"
#include "tracer/bake/fiv/occluder.h"
#include "tracer/lights/sphere.h"

namespace ivory {
namespace {

Scene crate_scene(const M44f& place) {
  Scene scene;
  scene.name = "crate";
  Mesh mesh = make_room(V3f(-0.5F, -0.5F, -0.5F), V3f(0.5F, 0.5F, 0.5F), add_lambert(scene, Rgb(0.7F, 0.7F, 0.7F)));
  for (auto& t : mesh.triangles) std::swap(t.y, t.z);  // fronts outward
  add_mesh(scene, std::move(mesh), place);
  return scene;
}

M44f turn(float x, float y, float z) {
  M44f m;
  m.setEulerAngles(V3f(x, y, z));
  return m;
}

TEST(FivOccluder, RefusesWhatHidesNothing) {
  Scene empty;
  empty.name = "empty";
  EXPECT_THROW(make_fiv_occluder(empty), Error);
}

TEST(FivPlacement, FindsMovedAndScaledCopiesOnly) {
  const FivOccluder occluder = make_fiv_occluder(bracket_scene());
  FivTable table;
  table.shape = occluder.shape;
  M44f place;
  place.setScale(0.3F);
  place *= M44f().setTranslation(V3f(5, -2, 7));
  const Scene moved = bracket_scene(place);
  const auto found = find_placement(table, moved, std::vector<bool>(3, true));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->radius_m, 0.3F * occluder.radius_m, 1e-4F);
  EXPECT_LT((found->center_m - (occluder.center_m * 0.3F + V3f(5, -2, 7))).length(), 1e-4F);

  EXPECT_FALSE(find_placement(table, moved, {true, false, true}));
  EXPECT_FALSE(find_placement(table, moved, {false, false, false}));
  EXPECT_FALSE(find_placement(table, ball_scene(), {true}));
  M44f turned;
  turned.setEulerAngles(V3f(0, 0.02F, 0));
  EXPECT_FALSE(find_placement(table, bracket_scene(turned), std::vector<bool>(3, true)));
}

// Second moments of a cube are those of a ball, however it is turned.
TEST(FivPlacement, RefusesTurnedCratesUnlessTheTurnLeavesThemAsTheyWere) {
  FivTable table;
  table.shape = make_fiv_occluder(crate_scene(M44f())).shape;
  const float degree = pi / 180;
  const auto found = [&](const M44f& m) {
    return find_placement(table, crate_scene(m * M44f().setTranslation(V3f(3, -1, 2))), {true}).has_value();
  };
  EXPECT_TRUE(found(M44f()));
  for (const float degrees : {1.0F, 5.0F, 30.0F, 45.0F, 89.0F}) {
    EXPECT_FALSE(found(turn(0, degrees * degree, 0))) << degrees;
    EXPECT_FALSE(found(turn(degrees * degree, 0, 0))) << degrees;
    EXPECT_FALSE(found(turn(0.3F * degrees * degree, 0, degrees * degree))) << degrees;
  }
  EXPECT_TRUE(found(turn(0, 90 * degree, 0)));
  EXPECT_TRUE(found(turn(180 * degree, 90 * degree, 0)));
}

TEST(FivOccluder, LeavesBallsOfLightOut) {
  const FivOccluder bare = make_fiv_occluder(bracket_scene());
  Scene lit = bracket_scene();
  add_sphere_light(lit, {V3f(5, 2, 0), 0.5F, Rgb(1, 1, 1)}, "test");
  const FivOccluder occluder = make_fiv_occluder(lit);
  EXPECT_EQ(occluder.center_m, bare.center_m);
  EXPECT_EQ(occluder.radius_m, bare.radius_m);
  EXPECT_EQ(occluder.shape, bare.shape);
  EXPECT_EQ(occluder.scene.instances.size(), bare.scene.instances.size());
  FivTable table;
  table.shape = bare.shape;
  EXPECT_TRUE(find_placement(table, lit, std::vector<bool>(lit.instances.size(), true)));
}

}  // namespace
}  // namespace ivory
