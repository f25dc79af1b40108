// Light does not change when a scene is shifted, turned, given in other units, subdivided, un-instanced or reordered.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "grid/cubemap/captured.h"
#include "grid/field/resolve.h"
#include "tests/support/scene_variants.h"
#include "tools/stability/fiv_shapes.h"
#include "tools/stability/scene_builder.h"
#include "tracer/bake/cubemap/capture.h"
#include "tracer/bake/field/baker.h"
#include "tracer/bake/fiv/baker.h"
#include "tracer/render/guard_rays.h"
#include "tracer/render/probe.h"

namespace ivory {
namespace {

// A room with an emissive quad, a point light and a spot, a glossy floor, three boxes of one mesh and a pane that lets
// half of the light pass.
Scene cluttered_room() {
  Scene scene = small_room();
  Mesh box = make_room(V3f(-0.1F, -0.1F, -0.1F), V3f(0.1F, 0.1F, 0.1F), add_lambert(scene, Rgb(0.8F, 0.4F, 0.2F)));
  for (auto& triangle : box.triangles) std::swap(triangle.y, triangle.z);  // fronts outward
  const int mesh = add_mesh(scene, box, M44f().setTranslation(V3f(-0.6F, -0.85F, 0.1F)));
  for (const V3f& at : {V3f(-0.3F, -0.4F, -0.6F), V3f(0.5F, 0.2F, 0.6F)}) {
    Instance instance;
    instance.mesh = mesh;
    instance.to_world.setEulerAngles(V3f(0.3F, 0.7F, 0.1F));
    instance.to_world *= M44f().setTranslation(at);
    scene.instances.push_back(instance);
  }
  const int pane = add_lambert(scene, Rgb(0.9F, 0.9F, 0.9F), Rgb(0, 0, 0), true);
  scene.materials[std::size_t(pane)].alpha_mode = AlphaMode::blend;
  scene.materials[std::size_t(pane)].alpha = 0.5F;
  add_mesh(scene, make_quad({-0.8F, 0.1F, -0.8F}, {0.7F, 0, 0}, {0, 0.1F, 0.9F}, pane));
  SpotLight spot;
  spot.position = V3f(0.4F, 0.8F, -0.4F);
  spot.direction = V3f(-0.6F, -0.8F, 0);
  spot.intensity_cd = Rgb(1.5F, 1.5F, 1.5F);
  spot.outer_angle_rad = 0.6F;
  scene.lights.push_back(spot);
  return scene;
}

// On the floor, the walls, the ceiling and in the middle of the room.
std::vector<ProbePoint> points() {
  std::vector<ProbePoint> all;
  for (int i = 0; i < 8; ++i) {
    const float a = -0.83F + 0.23F * float(i);
    const float b = 0.71F - 0.19F * float(i);
    all.push_back({V3f(a, -0.99F, b), V3f(0, 1, 0)});
    all.push_back({V3f(-1, b, a), V3f(1, 0, 0)});
    all.push_back({V3f(b, a, 1), V3f(0, 0, -1)});
    all.push_back({V3f(b * 0.5F, 0.05F, a * 0.5F), V3f(0.6F, 0.8F, 0)});
  }
  return all;
}

std::vector<ProbePoint> moved(std::vector<ProbePoint> all, const SceneVariant& variant) {
  for (ProbePoint& at : all) at = {at.p * variant.to_world, at.n * variant.rotation};
  return all;
}

double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(squares / double(a.size()));
}

// 32 points x 7 variants: 4.9 standard errors are passed by one right estimator in 4600.
TEST(Invariance, OfPaths) {
  const Scene scene = cluttered_room();
  ProbeParams params;
  params.samples = 256;
  const auto truth = probe_scene(make_lit_scene(scene), points(), params);
  params.seed = 2;
  for (SceneVariant& variant : variants(scene)) {
    const auto at = moved(points(), variant);
    const auto result = probe_scene(make_lit_scene(std::move(variant.scene)), at, params);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const float error = std::hypot(truth[i].standard_error.y, result[i].standard_error.y);
      EXPECT_NEAR(result[i].e.y, truth[i].e.y, 4.9F * error) << variant.name << ", point " << i;
    }
  }
}

std::vector<double> grid_light(const SceneVariant& variant, std::uint64_t seed) {
  const LitScene lit = make_lit_scene(variant.scene);
  GridBakeParams params;
  GridFrame frame = centred_frame(8, 2);
  frame.origin_m = frame.origin_m * variant.to_world;
  frame.spacing_m *= variant.metres_a_metre;
  frame.local_to_world = variant.rotation;
  params.frame = frame;
  params.photons = 100'000;
  params.seed = seed;
  const IrradianceGrid grid = resolve(bake_grid_sums(lit, params));
  std::vector<double> e;
  for (const ProbePoint& at : moved(points(), variant))
    e.push_back(double(lookup_irradiance(grid, &lit.intersector, at.p, at.n, at.n, {.guard = Guard::rays}).y));
  return e;
}

// Bakes by two seeds differ by noise alone, and a bake of a variant by no more: the RMS of 32 differences is itself
// good to 13 %, and neighbouring points share vertices; half more is four times that.
TEST(Invariance, OfGrids) {
  const Scene scene = cluttered_room();
  const SceneVariant original{"", scene};
  const std::vector<double> e = grid_light(original, 1);
  const double noise = rms_difference(e, grid_light(original, 2));
  double mean = 0;
  for (const double value : e) mean += value / double(e.size());
  EXPECT_LT(noise, 0.06 * mean);  // else the test would say little
  for (const SceneVariant& variant : variants(scene))
    EXPECT_LT(rms_difference(e, grid_light(variant, 3)), 1.5 * noise) << variant.name;
}

std::vector<double> cube_light(const SceneVariant& variant, std::uint64_t seed) {
  CaptureParams params;
  params.size = 32;
  params.samples = 16;
  params.seed = seed;
  const V3f at = V3f(-0.2F, 0.3F, 0.1F) * variant.to_world;
  const LocalizedCube cube = localize(capture_cube(make_lit_scene(variant.scene), at, params).cube, 4);
  std::vector<double> e;
  for (const ProbePoint& point : moved(points(), variant)) {
    const V3f near = at + (point.p - at) * 0.5F;
    e.push_back(double(irradiance(cube, CubeMethod::polygon, near, point.n).y));
  }
  return e;
}

// Cube maps have the world's axes, so a turned scene meets other texels: those are left out but for the quarter turn.
// Neighbouring points see the same few texels: the RMS of four differences by seed alone is good to a quarter, and
// twice that is four times its error.
TEST(Invariance, OfCubeMaps) {
  const Scene scene = cluttered_room();
  const SceneVariant original{"", scene};
  const std::vector<double> e = cube_light(original, 1);
  double squares = 0;
  for (std::uint64_t seed = 2; seed < 6; ++seed) squares += std::pow(rms_difference(e, cube_light(original, seed)), 2);
  const double noise = std::sqrt(squares / 4);
  for (const SceneVariant& variant : variants(scene)) {
    if (variant.name == "turned") continue;
    EXPECT_LT(rms_difference(e, cube_light(variant, 6)), 2 * noise) << variant.name;
  }
}

// The occluder's bounding sphere is found to 1e-3 of its radius. Silhouettes move by that, and a sample on the mesh may
// stand inside of it or not, for which its neighbours' mean is taken.
TEST(Invariance, OfOccluderTables) {
  Scene scene = bracket_scene();
  Instance second = scene.instances.front();
  second.to_world *= M44f().setTranslation(V3f(0.3F, 0.2F, -0.4F));
  scene.instances.push_back(second);
  const CubeMap light = coloured_cube(16);
  FivParams params;
  params.samples = V3i(16, 9, 6);
  params.environment_size = 8;
  const FivTable table = bake_fiv(make_fiv_occluder(scene), light, params);
  params.radii = table.radii;
  double greatest = 0;
  for (const float value : table.values) greatest = std::max(greatest, double(std::abs(value)));
  for (const SceneVariant& variant : variants(scene)) {
    if (variant.rotation != M33f()) continue;  // the environment does not turn with it
    const FivTable other = bake_fiv(make_fiv_occluder(variant.scene), light, params);
    EXPECT_NEAR(other.radius_m, table.radius_m * variant.metres_a_metre, 1e-3F * other.radius_m) << variant.name;
    double squares = 0;
    for (std::size_t i = 0; i < table.values.size(); ++i)
      squares += std::pow(double(table.values[i]) - double(other.values[i]), 2);
    EXPECT_LT(std::sqrt(squares / double(table.values.size())), 0.02 * greatest) << variant.name;
  }
}

}  // namespace
}  // namespace ivory
