// Objects that the viewer moves: along paths and under the mouse.
#include <cmath>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/command_test.h"
#include "tools/cli/usage_error.h"
#include "tools/view/world/controls.h"
#include "tools/view/world/drag.h"
#include "tools/view/world/path.h"

namespace ivory {
namespace {

class ObjectPathTest : public CommandTest {
 protected:
  std::string write(const std::string& text) const {
    std::ofstream(path("keys.csv"), std::ios::binary) << text;
    return "keys:" + path("keys.csv");
  }
};

TEST_F(ObjectPathTest, CircleAndLineComeBack) {
  const ObjectPath circle = parse_path("circle:2,8");
  EXPECT_EQ(at(circle, 0).offset_m, V3f(0, 0, 0));
  for (double t = 0; t < 8; t += 0.25) {
    EXPECT_NEAR((at(circle, t).offset_m - V3f(-2, 0, 0)).length(), 2, 1e-5F);
    EXPECT_LT((at(circle, t).offset_m - at(circle, t + 8).offset_m).length(), 1e-5F);
  }
  EXPECT_NEAR(at(circle, 4).offset_m.x, -4, 1e-5F);
  const ObjectPath line = parse_path("line:1,2,3,2");
  EXPECT_EQ(at(line, 0).offset_m, V3f(0, 0, 0));
  EXPECT_LT((at(line, 1).offset_m - V3f(1, 2, 3)).length(), 1e-5F);
  EXPECT_LT(at(line, 2).offset_m.length(), 1e-5F);
  EXPECT_LT((at(line, 0.5).offset_m - V3f(0.5F, 1, 1.5F)).length(), 1e-5F);
  EXPECT_EQ(at(ObjectPath{}, 3).offset_m, V3f(0, 0, 0));
}

TEST_F(ObjectPathTest, KeyframesAreJoinedByLines) {
  const ObjectPath keys = parse_path(write("t,x,y,z\n# comment\n0,0,0,0\r\n1,2,0,0\n\n4,2,0,3\n"));
  EXPECT_EQ(keys.keys.size(), 3U);
  EXPECT_LT((at(keys, 0.5).offset_m - V3f(1, 0, 0)).length(), 1e-6F);
  EXPECT_LT((at(keys, 3).offset_m - V3f(2, 0, 2)).length(), 1e-6F);
  EXPECT_LT((at(keys, 4.5).offset_m - V3f(1, 0, 0)).length(), 1e-6F);  // from the start again
  const ObjectPath unended = parse_path(write("0,1,1,1\n2,3,3,3"));
  EXPECT_LT((at(unended, 1).offset_m - V3f(2, 2, 2)).length(), 1e-6F);
}

TEST_F(ObjectPathTest, RefusesWhatIsNoPath) {
  for (const char* text : {"", "circle", "circle:", "circle:x", "circle:1,0", "circle:1,-2", "line:1,2",
                           "line:1,2,3,4,5", "spiral:1", "circle:nan"})
    EXPECT_THROW(parse_path(text), UsageError) << text;
  EXPECT_THROW(parse_path("keys:" + path("none.csv")), Error);
  EXPECT_THROW(parse_path("keys:" + folder_.string()), Error);
  for (const char* text : {"", "0,0,0,0\n", "0,0,0\n1,0,0,0\n", "1,0,0,0\n1,1,1,1\n", "-1,0,0,0\n1,0,0,0\n",
                           "0,0,0,inf\n1,0,0,0\n", "garbage\n"})
    EXPECT_THROW(parse_path(write(text)), Error) << text;
  EXPECT_THROW(parse_path(write(std::string(1000, '1') + ",0,0,0\n")), Error);
  std::string many;
  for (int i = 0; i < 100'001; ++i) many += std::to_string(i) + ",0,0,0\n";
  EXPECT_THROW(parse_path(write(many)), Error);
}

View test_view() { return make_view("test", framing_camera(V3f(0, 0, 0), 2, 4.0F / 3), 640, 480); }

// Projects p into pixels by searching for nothing: the view is a pinhole, so it follows from its axes.
V2f pixel_of(const View& view, const V3f& p) {
  const V3f d = p - view.origin;
  const float depth = d.dot(view.forward);
  const float x = d.dot(view.right) / view.right.length2() / depth;
  const float y = d.dot(view.up) / view.up.length2() / depth;
  return {(x + 1) * 0.5F * float(view.width), (1 - y) * 0.5F * float(view.height)};
}

TEST(ViewDrag, GrabbedPointStaysUnderTheMouse) {
  const View view = test_view();
  std::mt19937 random(7);
  std::uniform_real_distribution<float> u(-1, 1);
  for (const DragPlane plane : {DragPlane::view, DragPlane::ground}) {
    for (int i = 0; i < 200; ++i) {
      const V3f grabbed(u(random), u(random) - 0.5F, u(random));
      const V3f offset(3, 1, -2);
      const Drag drag = begin_drag(view, grabbed, offset, plane, 100);
      const V2f pixel = pixel_of(view, grabbed) + V2f(80 * u(random), 60 * u(random));
      const std::optional<V3f> moved = drag_to(drag, view, pixel);
      ASSERT_TRUE(moved);
      const V3f by = *moved - offset;
      const V2f seen = pixel_of(view, grabbed + by);
      EXPECT_NEAR(seen.x, pixel.x, 0.05F);
      EXPECT_NEAR(seen.y, pixel.y, 0.05F);
      EXPECT_NEAR(by.dot(plane == DragPlane::view ? view.forward : V3f(0, 1, 0)), 0, 1e-4F);
    }
  }
}

TEST(ViewDrag, StaysWhereThePlaneIsOutOfReach) {
  const View view = test_view();
  const Drag drag = begin_drag(view, V3f(0, 0, 0), V3f(0, 0, 0), DragPlane::ground, 10);
  EXPECT_FALSE(drag_to(drag, view, V2f(320, -2000)));  // above the horizon: the plane lies behind the eye
  EXPECT_FALSE(drag_to(drag, view, V2f(320, -200)));   // near the horizon: too far
  // Edge-on: a level view along the ground.
  Camera level;
  const View flat = make_view("test", level, 100, 100);
  const Drag along = begin_drag(flat, V3f(0, 0, -2), V3f(0, 0, 0), DragPlane::ground, 10);
  EXPECT_FALSE(drag_to(along, flat, V2f(50, 50)));
}

// A wall behind a triangle that moves.
ViewWorld small_world() {
  const auto triangle = [](float size, float z) {
    Scene scene;
    scene.materials.emplace_back();
    Mesh mesh;
    mesh.positions = {{-size, -size, z}, {size, -size, z}, {0, size, z}};
    mesh.triangles.emplace_back(0U, 1U, 2U);
    mesh.material = 0;
    scene.meshes.push_back(mesh);
    scene.instances.push_back({0, M44f(), no_index});
    return scene;
  };
  ViewWorld world;
  world.objects.push_back(make_object("wall", triangle(20, -5), V3f(0, 0, 0), false));
  world.objects.push_back(make_object("thing", triangle(0.5F, 0), V3f(0, 0.25F, 0), true));
  measure(world);
  Camera camera;
  camera.to_world.setTranslation(V3f(0, 1, 3));
  world.camera = make_view_camera(camera, V3f(0, 0, 0), 1);
  return world;
}

TEST(ViewControls, DragsWhatIsUnderTheMouseAndOrbitsElsewhere) {
  const Imath::V2i size(400, 400);
  ViewWorld world = small_world();
  const ViewCamera start = world.camera;
  ViewControls controls;
  // tan(0.4) of half a picture's height is a metre's 1 / (2.5 m) below: the thing's middle is 0.9 m below the axis.
  const V2f thing(200, 200 + 200 * (0.85F / 3) / std::tan(0.4F));
  controls.press(world, MouseButton::left, thing, size, DragMode::plane);
  EXPECT_EQ(controls.selected(), 1U);
  EXPECT_TRUE(controls.move(world, thing + V2f(50, -20), size));
  const float pixel_m = 3 * std::tan(0.4F) / 200;
  EXPECT_NEAR(world.objects[1].offset_m.x, 50 * pixel_m, 1e-3F);
  EXPECT_NEAR(world.objects[1].offset_m.y, 0.25F + 20 * pixel_m, 1e-3F);
  EXPECT_EQ(world.objects[0].offset_m, V3f(0, 0, 0));
  controls.release(MouseButton::left);
  EXPECT_FALSE(controls.move(world, thing, size));
  EXPECT_EQ(eye(world.camera), eye(start));

  controls.press(world, MouseButton::left, V2f(30, 300), size, DragMode::ground);  // the wall does not move
  EXPECT_TRUE(controls.move(world, V2f(60, 300), size));
  EXPECT_GT((eye(world.camera) - eye(start)).length(), 0.01F);
  EXPECT_LT((pivot(world.camera) - pivot(start)).length(), 1e-5F);
  controls.release(MouseButton::left);
}

TEST(ViewControls, KeysFlyUntilReleased) {
  ViewWorld world = small_world();
  ViewControls controls;
  const V3f start = eye(world.camera);
  EXPECT_FALSE(controls.advance(world, 1, false));
  controls.press(world, FlyKey::forward);
  const V3f pressed = eye(world.camera);
  EXPECT_LT(pressed.z, start.z);  // even where no time passes before the release
  EXPECT_TRUE(controls.advance(world, 0.05F, false));
  EXPECT_LT(eye(world.camera).z, pressed.z);
  controls.release(FlyKey::forward);
  EXPECT_FALSE(controls.flies());
  EXPECT_FALSE(controls.advance(world, 1, false));
  controls.press(world, FlyKey::left);
  controls.release_all();
  EXPECT_FALSE(controls.flies());
}

TEST(ViewControls, PickFindsMovedObjects) {
  ViewWorld world = small_world();
  Ray ray;
  ray.origin = V3f(2, 0.2F, 3);
  ray.direction = V3f(0, 0, -1);
  const auto object_at = [&](float x) {
    ray.origin.x = x;
    const std::optional<Pick> found = pick(world, ray);
    return found ? int(found->object) : -1;
  };
  EXPECT_EQ(object_at(2), 0);
  world.objects[1].offset_m = V3f(2, 0.25F, 0);
  EXPECT_EQ(object_at(2), 1);
  EXPECT_EQ(object_at(0), 0);
  EXPECT_EQ(object_at(200), -1);
  ray.origin.x = 2;
  const Pick found = pick(world, ray).value_or(Pick{0, V3f(0, 0, 0)});
  EXPECT_LT((found.point_m - V3f(2, 0.2F, 0)).length(), 1e-5F);
}

}  // namespace
}  // namespace ivory
