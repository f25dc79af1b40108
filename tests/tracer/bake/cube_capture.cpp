// What a cube map captures of scenes whose light is known.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/emissive_texture.h"
#include "tracer/bake/cubemap/capture.h"
#include "tracer/render/probe.h"

namespace ivory {
namespace {

// A box of 2 x 3 x 4 m, turned and moved.
M44f turned() {
  M44f m;
  m.rotate(V3f(0.3F, -0.7F, 1.1F));
  m[3][0] = 20;
  m[3][1] = -3;
  m[3][2] = 8;
  return m;
}
const V3f low(-1, -1.5F, -2), high(1, 1.5F, 2);

Scene glowing_box(const Rgb& albedo, const M44f& to_world) {
  Scene scene;
  add_mesh(scene, make_room(low, high, add_lambert(scene, albedo, Rgb(1, 2, 3))), to_world);
  return scene;
}

V3f random_point(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0.01F, 0.99F);
  V3f p;
  for (unsigned c = 0; c < 3; ++c) p[c] = low[c] + (high[c] - low[c]) * unit(random);
  return p;
}

V3f random_unit(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return V3f(normal(random), normal(random), normal(random)).normalized();
}

// Walls that emit L and reflect nothing: no noise, L from everywhere and E = pi L at every point, though the shell
// of a few texels cuts the box's corners. A point there, outside of the shell, reads what it is moved to.
TEST(CubeCapture, ClosedBoxGivesPiAtEveryPoint) {
  std::mt19937 random(1);
  for (const M44f& to_world : {M44f(), turned()}) {
    const LitScene box = make_lit_scene(glowing_box(Rgb(0, 0, 0), to_world));
    for (int trial = 0; trial < 4; ++trial) {
      CaptureParams params;
      params.size = 32;
      params.samples = 1;
      const Capture capture = capture_cube(box, random_point(random) * to_world, params);
      EXPECT_EQ(capture.sky_share, 0);
      EXPECT_EQ(capture.back_share, 0);
      for (const int size : {2, 4, 8}) {
        const LocalizedCube cube = localize(capture.cube, size);
        ASSERT_EQ(find_fault(cube), "");
        for (int i = 0; i < 500; ++i) {
          const Rgb e = irradiance(cube, CubeMethod::polygon, random_point(random) * to_world, random_unit(random));
          for (int c = 0; c < 3; ++c) ASSERT_NEAR(e[c] / (pi * float(c + 1)), 1, 1e-3F);
        }
      }
    }
  }
}

TEST(CubeCapture, DistancesAreToTheWalls) {
  const M44f to_world = turned();
  const LitScene box = make_lit_scene(glowing_box(Rgb(0, 0, 0), to_world));
  const V3f local(0.3F, -0.4F, 1.2F);
  CaptureParams params;
  params.size = 16;
  params.samples = 1;
  const Capture capture = capture_cube(box, local * to_world, params);
  const M44f to_local = to_world.inverse();
  std::size_t i = 0;
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < 16; ++row) {
      for (int column = 0; column < 16; ++column, ++i) {
        V3f w;
        to_local.multDirMatrix(cube_texel_direction(16, face, row, column), w);
        float inverse = 0;
        for (unsigned c = 0; c < 3; ++c) inverse = std::max(inverse, w[c] / ((w[c] > 0 ? high[c] : low[c]) - local[c]));
        // 20 m from the world's origin a coordinate is good to 1e-6 m, the nearest wall 0.7 m away.
        ASSERT_NEAR(capture.cube.inverse_distance[i] / inverse, 1, 1e-5F) << i;
      }
    }
  }
}

// E by the map at its own reference point against path-traced E there: emission, direct and indirect light, the sky.
TEST(CubeCapture, AgreesWithPathTracingAtTheReferencePoint) {
  Scene scene = small_room();
  scene.lights.clear();
  scene.instances.erase(scene.instances.begin() + 3);
  scene.environment = uniform_environment(Rgb(3, 2, 1));
  // Light from the sky comes through the wall that was taken out.
  Mesh& room = scene.meshes[0];
  room.triangles.erase(room.triangles.begin() + 8, room.triangles.begin() + 10);
  const LitScene traced = make_lit_scene(std::move(scene));
  const V3f at(0.2F, 0.1F, -0.3F);
  CaptureParams params;
  params.size = 64;
  params.samples = 16;
  const Capture capture = capture_cube(traced, at, params);
  EXPECT_GT(capture.sky_share, 0.05);
  EXPECT_LT(capture.sky_share, 0.3);
  const LocalizedCube cube = localize(capture.cube, 32);
  std::vector<ProbePoint> points;
  for (const V3f& n : {V3f(1, 0, 0), V3f(-1, 0, 0), V3f(0, 1, 0), V3f(0, -1, 0), V3f(0, 0, 1), V3f(0, 0, -1)})
    points.push_back({at, n});
  ProbeParams probe;
  probe.samples = 20000;
  const auto truth = probe_scene(traced, points, probe);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Rgb e = irradiance(cube, CubeMethod::polygon, at, points[i].n);
    for (int c = 0; c < 3; ++c) {
      // Noise of both, the map's well below the probe's, and the blur of the lamp's edge over texels.
      EXPECT_NEAR(e[c], truth[i].e[c], 5 * truth[i].standard_error[c] + 0.01F * truth[i].e[c]) << points[i].n;
    }
  }
}

// A sign of four bright texels, smaller than a ray in a million would meet, and a panel of the same flux.
TEST(CubeCapture, SmallEmittersAreSeen) {
  for (const bool sign : {true, false}) {
    Scene scene;
    const int texture = add_texture(scene, 1024, 1024, [&](int x, int y) {
      return !sign || (x % 512 == 100 && y % 512 == 300) ? Texel{255, 255, 255, 255} : Texel{0, 0, 0, 255};
    });
    add_panel(scene, 2, texture, Rgb(1, 2, 3) * (1000 / pi * (sign ? 0x1p18F : 1.0F)));
    const LitScene traced = make_lit_scene(std::move(scene));
    CaptureParams params;
    params.size = 32;
    params.samples = 16;
    const LocalizedCube cube = localize(capture_cube(traced, V3f(0, 0, 0), params).cube, 32);
    ProbeParams probe;
    probe.samples = 20000;
    const ProbeResult truth = probe_scene(traced, {{V3f(0, 0, 0), V3f(0, 1, 0)}}, probe)[0];
    const Rgb e = irradiance(cube, CubeMethod::polygon, V3f(0, 0, 0), V3f(0, 1, 0));
    // As many light samples as the probe's, and the place in a texel of 3 degrees.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(e[c], truth.e[c], 6 * truth.standard_error[c] + 0.01F * truth.e[c]) << sign;
  }
}

// A point light is not seen; what it lights is.
TEST(CubeCapture, PunctualLightsAreSeenByWhatTheyLight) {
  Scene scene;
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F))));
  scene.lights.push_back(PointLight{V3f(0, 0, 0), Rgb(1, 1, 1)});
  const LitScene traced = make_lit_scene(std::move(scene));
  CaptureParams params;
  params.size = 32;
  params.samples = 64;
  const Capture capture = capture_cube(traced, V3f(0.1F, 0.2F, -0.3F), params);
  // Flux 4 pi reaches the walls, on average 4 pi / 24 lux, and 1 / (1 - albedo) times in the end: the mean radiosity is
  // 0.5 / 0.5 4 pi / 24, all of it diffuse. The mean over directions from near the middle is close to that over
  // area: within a fifth.
  double mean = 0;
  for (const Rgb& radiance : capture.cube.radiance.texels)
    mean += double(radiance.x) / double(capture.cube.radiance.texels.size());
  EXPECT_NEAR(mean / (4.0 / 24), 1, 0.2);
}

TEST(CubeCapture, KnowsSolidsFromRooms) {
  Scene scene = small_room();
  const LitScene traced = make_lit_scene(std::move(scene));
  CaptureParams params;
  params.size = 8;
  params.samples = 1;
  EXPECT_EQ(capture_cube(traced, V3f(0, 0, 0), params).back_share, 0);
  // In the box that stands in the room.
  EXPECT_GT(capture_cube(traced, V3f(0.3F, -0.6F, 0), params).back_share, 0.99);
}

}  // namespace
}  // namespace ivory
