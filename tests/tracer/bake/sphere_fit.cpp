// Sphere sets fitted to meshes of known shape, in all sizes and conditions.
#include <cmath>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tools/stability/scene_builder.h"
#include "tracer/bake/spheres/fit.h"
#include "tracer/bake/spheres/winding_number.h"
#include "tracer/lights/sphere.h"

namespace ivory {
namespace {

// A ball as a latitude-longitude mesh, fronts outward.
Mesh make_ball(const V3f& center, float radius, int rings = 24) {
  Mesh mesh;
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j < 2 * rings; ++j) {
      const float theta = pi * float(i) / float(rings);
      const float phi = pi * float(j) / float(rings);
      mesh.positions.push_back(
          center + V3f(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi)) * radius);
    }
  }
  const auto at = [&](int i, int j) { return std::uint32_t(i * 2 * rings + j % (2 * rings)); };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < 2 * rings; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  mesh.material = 0;
  return mesh;
}

Scene scene_of(Mesh mesh, const M44f& to_world = M44f()) {
  Scene scene;
  scene.name = "test";
  add_lambert(scene, Rgb(1, 1, 1));
  add_mesh(scene, std::move(mesh), to_world);
  return scene;
}

SphereFitParams few(int count, int resolution = 40) {
  SphereFitParams params;
  params.count = count;
  params.resolution = resolution;
  return params;
}

std::vector<Triangle3d> triangles_of(const Mesh& mesh) {
  std::vector<Triangle3d> list;
  for (const auto& t : mesh.triangles)
    list.push_back({V3d(mesh.positions[t.x]), V3d(mesh.positions[t.y]), V3d(mesh.positions[t.z])});
  return list;
}

// Dipoles are good to some 0.02, a tenth of what would blur inside and outside.
TEST(WindingNumber, TellsInsideFromOutside) {
  Mesh ball = make_ball(V3f(0, 0, 0), 1);
  const WindingNumber winding(triangles_of(ball));
  for (const V3d& p : {V3d(0, 0, 0), V3d(0.5, 0.5, 0.5), V3d(0, -0.95, 0)}) EXPECT_NEAR(winding.at(p), 1, 0.03);
  for (const V3d& p : {V3d(1.1, 0, 0), V3d(0.7, 0.7, 0.7), V3d(0, -30, 0)}) EXPECT_NEAR(winding.at(p), 0, 0.03);
  for (auto& t : ball.triangles) std::swap(t.y, t.z);
  EXPECT_NEAR(WindingNumber(triangles_of(ball)).at(V3d(0.2, 0.1, 0)), -1, 0.03);
  EXPECT_EQ(WindingNumber({}).at(V3d(0, 0, 0)), 0);
}

// The tree of dipoles against the plain sum of solid angles, a leaf at a time.
TEST(WindingNumber, AgreesWithTheSumOverTriangles) {
  std::vector<Triangle3d> all = triangles_of(make_ball(V3f(0, 0, 0), 1, 20));
  all.resize(all.size() / 3);  // an open cap
  const WindingNumber winding(all);
  for (int i = 0; i < 50; ++i) {
    const V3d p(std::sin(i * 1.3), std::cos(i * 2.1) * 1.2, std::sin(i * 0.7 + 1));
    double sum = 0;
    for (const Triangle3d& t : all) sum += WindingNumber({t}).at(p);
    EXPECT_NEAR(winding.at(p), sum, 0.03);
  }
}

TEST(SphereFit, ABallIsOneSphere) {
  const SphereFit fit = fit_spheres(scene_of(make_ball(V3f(3, -2, 1), 0.5F)), few(1));
  ASSERT_EQ(fit.set.spheres.size(), 1U);
  // Half a voxel: 1/80 of the diameter.
  EXPECT_LT((fit.set.spheres[0].center - V3f(3, -2, 1)).length(), 0.0125F);
  EXPECT_NEAR(fit.set.spheres[0].radius_m, 0.5F, 0.0125F);
  EXPECT_LT(fit.errors.volume_outside + fit.errors.volume_uncovered, 0.06);
  EXPECT_NEAR(fit.errors.mesh_volume_m3, 4.0 / 3 * 3.14159 * 0.125, 0.01);
  EXPECT_TRUE(fit.solid);
}

TEST(SphereFit, MoreSpheresFitBetter) {
  Mesh box = make_room(V3f(0, 0, 0), V3f(1, 0.6F, 0.4F), 0);
  for (auto& t : box.triangles) std::swap(t.y, t.z);
  double before = 10;
  for (const int count : {1, 4, 16, 64}) {
    const SphereFit fit = fit_spheres(scene_of(box), few(count));
    const double difference = fit.errors.volume_outside + fit.errors.volume_uncovered;
    EXPECT_LT(difference, 0.8 * before) << count;
    before = difference;
  }
  EXPECT_LT(before, 0.2);
}

// The same shape however it is given: turned inside out, tiny, huge, far from the origin, mirrored.
TEST(SphereFit, DoesNotDependOnHowTheMeshIsGiven) {
  Mesh box = make_room(V3f(0, 0, 0), V3f(1, 0.6F, 0.4F), 0);
  const SphereFit inside_out = fit_spheres(scene_of(box), few(8));
  for (auto& t : box.triangles) std::swap(t.y, t.z);
  const SphereFit plain = fit_spheres(scene_of(box), few(8));
  ASSERT_EQ(plain.set.spheres.size(), inside_out.set.spheres.size());
  for (std::size_t i = 0; i < plain.set.spheres.size(); ++i)
    EXPECT_EQ(plain.set.spheres[i].center, inside_out.set.spheres[i].center);
  for (const float scale : {1e-4F, 1e5F}) {
    M44f m;
    m.scale(V3f(scale, scale, scale));
    const SphereFit fit = fit_spheres(scene_of(box, m), few(8));
    EXPECT_NEAR(fit.errors.volume_outside, plain.errors.volume_outside, 0.01);
    EXPECT_NEAR(fit.set.spheres[0].radius_m / scale, plain.set.spheres[0].radius_m, 0.02F);
  }
  M44f far;
  far.translate(V3f(10000, -20000, 5000));
  const SphereFit there = fit_spheres(scene_of(box, far), few(8));
  EXPECT_NEAR(there.errors.volume_outside, plain.errors.volume_outside, 0.02);
  M44f mirror;
  mirror.scale(V3f(-1, 1, 1));
  EXPECT_TRUE(fit_spheres(scene_of(box, mirror), few(8)).solid);
}

TEST(SphereFit, HolesDoNotMatter) {
  Mesh ball = make_ball(V3f(0, 0, 0), 1);
  ball.triangles.resize(ball.triangles.size() * 9 / 10);  // the bottom is open
  const SphereFit fit = fit_spheres(scene_of(ball), few(1));
  EXPECT_TRUE(fit.solid);
  EXPECT_NEAR(fit.set.spheres[0].radius_m, 1, 0.05F);
}

TEST(SphereFit, OrientationDoesNotMatter) {
  Mesh ball = make_ball(V3f(0, 0, 0), 1);
  std::uint32_t state = 1;
  for (auto& t : ball.triangles) {
    state = state * 1664525U + 1013904223U;
    if ((state >> 30U & 1U) != 0) std::swap(t.y, t.z);
  }
  const SphereFit fit = fit_spheres(scene_of(ball), few(1));
  EXPECT_TRUE(fit.solid);
  EXPECT_NEAR(fit.set.spheres[0].radius_m, 1, 0.05F);
}

TEST(SphereFit, SheetsAreCovered) {
  const SphereFit fit = fit_spheres(scene_of(make_quad({0, 0, 0}, {2, 0, 0}, {0, 0, -1}, 0)), few(32));
  EXPECT_FALSE(fit.solid);
  EXPECT_LT(fit.errors.surface_uncovered, 0.35);
  for (const Sphere& s : fit.set.spheres) {
    EXPECT_GT(s.radius_m, 0);
    EXPECT_LT(std::abs(s.center.y), 0.2F);
  }
}

TEST(SphereFit, LightsCastNoShadowAndAreNotFitted) {
  Scene scene = scene_of(make_ball(V3f(0, 0, 0), 1));
  add_sphere_light(scene, {V3f(9, 0, 0), 3, Rgb(1, 1, 1)}, "test");
  EXPECT_NEAR(fit_spheres(scene, few(1)).set.spheres[0].radius_m, 1, 0.03F);
}

TEST(SphereFit, NothingToFitIsAnError) {
  Scene empty;
  empty.name = "empty";
  EXPECT_THROW(fit_spheres(empty, few(4)), Error);
  Mesh flat;
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  flat.triangles.emplace_back(0, 1, 2);
  flat.triangles.emplace_back(0, 0, 1);
  flat.material = 0;
  EXPECT_THROW(fit_spheres(scene_of(flat), few(4)), Error);
}

}  // namespace
}  // namespace ivory
