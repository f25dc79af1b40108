// Where a grid stands, and how many threads its bake takes.
#include <cmath>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/field/resolve.h"
#include "tools/stability/fiv_shapes.h"
#include "tracer/bake/field/baker.h"

namespace ivory {
namespace {

// The room of small_room(), or that in the middle of a grey dome of 1 km.
Scene room_under_dome(bool dome) {
  Scene scene = small_room();
  if (!dome) return scene;
  Mesh sky = make_ball(1000, 16, add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F), Rgb(0, 0, 0), /*double_sided=*/true));
  add_mesh(scene, std::move(sky));
  return scene;
}

GridBakeParams small_bake(std::uint64_t seed) {
  GridBakeParams params;
  params.resolution = V3i(8, 8, 8);
  params.photons = 200'000;
  params.seed = seed;
  params.threads = 2;
  return params;
}

GridAccumulator bake(const Scene& scene, const GridBakeParams& params) {
  return bake_grid_sums(make_lit_scene(scene), params);
}

double squares(const IrradianceGrid& a, const IrradianceGrid& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.moments.size(); ++i) sum += std::pow(double(a.moments[i]) - double(b.moments[i]), 2);
  return sum;
}

TEST(GridPlacement, CoversTheBoundsGivenWhateverIsAround) {
  const Box3f box(V3f(-1, -1, -1), V3f(1, 1, 1));
  GridBakeParams in_dome = small_bake(1);
  in_dome.bounds = box;
  const Scene dome = room_under_dome(true);
  const GridFrame frame = default_frame(dome, in_dome);
  EXPECT_LT((frame.to_world(V3f(-0.5F, -0.5F, -0.5F)) - box.min).length(), 1e-5F);
  EXPECT_LT((frame.to_world(V3f(7.5F, 7.5F, 7.5F)) - box.max).length(), 1e-5F);

  // Light under the dome is that of the room alone: the two differ as two bakes of the room do. Both squares are sums
  // over 512 vertices of 36 moments; 1.3 is beyond what a sum of some hundred independent squares reaches (4 sigma).
  const IrradianceGrid with = resolve(bake(dome, in_dome));
  const Scene room = room_under_dome(false);
  const IrradianceGrid alone = resolve(bake(room, small_bake(2)));
  const IrradianceGrid again = resolve(bake(room, small_bake(3)));
  const double noise = squares(alone, again);
  EXPECT_GT(noise, 0);
  EXPECT_LT(squares(with, alone), 1.3 * noise);
  EXPECT_EQ(with.frame.size, alone.frame.size);
}

TEST(GridPlacement, TurnsAboutTheMiddleOfTheBounds) {
  GridBakeParams params = small_bake(1);
  params.bounds = Box3f(V3f(2, 0, -1), V3f(6, 1, 1));
  params.rotate_y_deg = 30;
  const GridFrame frame = default_frame(small_room(), params);
  EXPECT_LT((frame.to_world(V3f(3.5F, 3.5F, 3.5F)) - V3f(4, 0.5F, 0)).length(), 1e-5F);
  const float c = std::cos(pi / 6);
  // The middle of the side at local +x: world +X turns towards -Z.
  EXPECT_LT((frame.to_world(V3f(7.5F, 3.5F, 3.5F)) - V3f(4 + 2 * c, 0.5F, -1)).length(), 1e-5F);
  EXPECT_LT((frame.to_world(V3f(3.5F, 3.5F, 7.5F)) - V3f(4.5F, 0.5F, c)).length(), 1e-5F);
}

// A turned room in a grid turned with it: no vertex is wasted.
TEST(GridPlacement, FindsTheBoundsOfTheSceneAlongTurnedAxes) {
  M44f turned;
  turned.setEulerAngles(V3f(0, pi / 6, 0));
  Scene scene;
  scene.name = "turned";
  add_mesh(scene, make_room(V3f(3, 0, -2), V3f(5, 1, 2), add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F))), turned);
  GridBakeParams params = small_bake(1);
  params.rotate_y_deg = 30;
  const GridFrame frame = default_frame(scene, params);
  EXPECT_LT((frame.spacing_m - V3f(2, 1, 4) / 8).length(), 1e-5F);
  EXPECT_LT((frame.to_world(V3f(-0.5F, -0.5F, -0.5F)) - V3f(3, 0, -2) * turned).length(), 1e-5F);
}

TEST(GridThreads, AreAsManyAsMemoryHolds) {
  const Scene scene = small_room();
  GridBakeParams params = small_bake(1);
  const GridFrame frame = default_frame(scene, params);
  const LitScene lit = make_lit_scene(scene);
  const GridAccumulator free = bake(scene, params);
  params.threads = 1000;
  params.max_memory_bytes = 40'000'000;  // 1000 threads would need 2 GB and more
  const int threads = affordable_threads(lit, frame, params);
  EXPECT_GE(threads, 1);
  EXPECT_LT(threads, 20);
  const GridAccumulator bound = bake(scene, params);
  EXPECT_EQ(bound.sums, free.sums);
  EXPECT_EQ(bound.counters, free.counters);
  params.max_memory_bytes = 100'000;
  EXPECT_THROW(affordable_threads(lit, frame, params), Error);
  EXPECT_THROW(bake(scene, params), Error);
}

}  // namespace
}  // namespace ivory
