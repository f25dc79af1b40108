// The viewer's camera against the rays of ivory render, and its moves against what they promise.
#include "tools/view/world/camera.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tracer/core/camera.h"

namespace ivory {
namespace {

Camera random_camera(std::mt19937& random) {
  std::uniform_real_distribution<float> u(-1, 1);
  Camera camera;
  camera.to_world.setEulerAngles(V3f(u(random) * 0.6F, u(random) * 3, u(random) * 0.4F));
  camera.to_world.scale(V3f(1 + 0.5F * u(random), 2, 0.7F));
  for (unsigned c = 0; c < 3; ++c) camera.to_world[3][c] = 3 * u(random);
  camera.perspective = u(random) > -0.4F;
  camera.yfov_rad = 0.9F + 0.5F * u(random);
  camera.ymag_m = 1.5F;
  return camera;
}

V3f ndc(const ViewMatrices& m, const V3f& p) {
  V3f out;
  (m.world_to_eye * m.projection).multVecMatrix(p, out);  // divides by w
  return out;
}

TEST(ViewCamera, RasterisesWhereRaysOfRenderGo) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> u(0, 1);
  constexpr int width = 97;
  constexpr int height = 61;
  for (int i = 0; i < 1000; ++i) {
    const Camera camera = random_camera(random);
    const V2f shift(u(random) - 0.5F, u(random) - 0.5F);
    const ViewMatrices m = view_matrices("test", camera, width, height, shift, V3f(0, 0, 0), 10);
    const View view = make_view("test", camera, width, height);
    const V2f pixel(u(random) * width, u(random) * height);
    const Ray ray = make_ray(view, pixel);
    const V3f p = ray.origin + ray.direction * (0.5F + 5 * u(random));
    const V3f at = ndc(m, p);
    // A thousandth of a pixel: some tens of roundings of numbers near 100.
    EXPECT_NEAR((at.x + 1) * 0.5F * width, pixel.x + shift.x, 2e-3F) << i;
    EXPECT_NEAR((1 - at.y) * 0.5F * height, pixel.y + shift.y, 2e-3F) << i;
    EXPECT_LE(std::abs(at.z), 1) << i;
  }
}

TEST(ViewCamera, DepthGrowsWithDistanceAndHoldsTheSphere) {
  std::mt19937 random(2);
  for (int i = 0; i < 200; ++i) {
    const Camera camera = random_camera(random);
    const V3f center(1, 2, 3);
    const ViewMatrices m = view_matrices("test", camera, 64, 64, V2f(0, 0), center, 4);
    const View view = make_view("test", camera, 64, 64);
    float last = -1;
    const float middle = (center - view.origin).dot(view.forward);
    // From the near side of the sphere, or just before the eye where it stands inside, to the far side.
    const float first = std::max(middle - 4, 2e-3F * (std::abs(middle) + 4));
    for (float depth = first; depth < middle + 4; depth += 0.25F) {
      const float z = ndc(m, view.origin + view.forward * depth).z;
      EXPECT_GT(z, last);
      EXPECT_LT(z, 1);
      last = z;
    }
  }
}

TEST(ViewCamera, OrbitKeepsPivotAndDistance) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const ViewCamera start = make_view_camera(random_camera(random), V3f(0, 0, 0), 2);
    const ViewCamera end = orbit(start, u(random), u(random));
    EXPECT_LT((pivot(end) - pivot(start)).length(), 1e-4F);
    EXPECT_NEAR((eye(end) - pivot(end)).length(), start.pivot_distance_m, 1e-4F * start.pivot_distance_m);
  }
}

TEST(ViewCamera, MovesTheWayTheMouseSays) {
  const ViewCamera start = make_view_camera(framing_camera(V3f(0, 0, 0), 1, 1), V3f(0, 0, 0), 1);
  const V3f right = forward(start).cross(V3f(0, 1, 0));
  EXPECT_GT((eye(orbit(start, 0.1F, 0)) - eye(start)).dot(right), 0);
  EXPECT_GT(eye(orbit(start, 0, 0.1F)).y, eye(start).y);
  EXPECT_LT(forward(look(start, 0.1F, 0)).dot(right), 0);
  EXPECT_GT(forward(look(start, 0, 0.1F)).y, forward(start).y);
  EXPECT_EQ(eye(look(start, 0.3F, 0.2F)), eye(start));
  EXPECT_NEAR((eye(fly(start, V3f(0, 0, 0.5F))) - eye(start)).dot(forward(start)), 0.5F, 1e-5F);
  EXPECT_NEAR((eye(fly(start, V3f(0.25F, 0, 0))) - eye(start)).dot(right.normalized()), 0.25F, 1e-5F);
  const ViewCamera near = dolly(start, 0.5F);
  EXPECT_LT((pivot(near) - pivot(start)).length(), 1e-5F);
  EXPECT_NEAR(near.pivot_distance_m, 0.5F * start.pivot_distance_m, 1e-5F);
}

TEST(ViewCamera, NeverTurnsOverAPole) {
  ViewCamera view = make_view_camera(framing_camera(V3f(0, 0, 0), 1, 1), V3f(0, 0, 0), 1);
  for (int i = 0; i < 200; ++i) view = orbit(view, 0.1F, i < 100 ? 0.2F : -0.2F);
  const V3f up(view.camera.to_world[1][0], view.camera.to_world[1][1], view.camera.to_world[1][2]);
  EXPECT_GT(up.y, 0);
  EXPECT_LT(std::abs(forward(view).y), 0.9999F);
  for (int i = 0; i < 100; ++i) view = look(view, -0.1F, 0.3F);
  EXPECT_LT(std::abs(forward(view).y), 0.9999F);
  // A camera that starts straight down may come back up.
  Camera down;
  down.to_world.setEulerAngles(V3f(-pi / 2, 0, 0));
  const ViewCamera back = look(make_view_camera(down, V3f(0, -1, 0), 1), 0, 0.5F);
  EXPECT_GT(forward(back).y, -0.9F);
}

TEST(ViewCamera, FramesASphere) {
  std::mt19937 random(4);
  for (int i = 0; i < 100; ++i) {
    const ViewCamera view =
        frame_sphere(make_view_camera(random_camera(random), V3f(0, 0, 0), 1), V3f(5, 6, 7), 2, 1.5F);
    const ViewMatrices m = view_matrices("test", view.camera, 150, 100, V2f(0, 0), V3f(5, 6, 7), 2);
    const V3f middle = ndc(m, V3f(5, 6, 7));
    EXPECT_NEAR(middle.x, 0, 1e-4F);
    EXPECT_NEAR(middle.y, 0, 1e-4F);
    const View v = make_view("test", view.camera, 150, 100);
    const V3f top = ndc(m, V3f(5, 6, 7) + v.up.normalized() * 2);
    EXPECT_LE(std::abs(top.y), 1.0001F);
    EXPECT_GT(std::abs(top.y), 0.5F);
  }
}

}  // namespace
}  // namespace ivory
