// The photon map against closed forms and against the path tracer.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/lit_scene.h"
#include "tools/stability/fiv_shapes.h"
#include "tracer/render/photons/map.h"
#include "tracer/render/photons/tracer.h"
#include "tracer/render/probe.h"

namespace ivory {
namespace {

// A sphere of radius 1, seen from inside, and a light in its middle.
Scene integrating_sphere(float albedo) {
  Scene scene;
  scene.name = "sphere";
  const int wall = add_lambert(scene, Rgb(albedo, albedo, albedo));
  Mesh ball = make_ball(1, 48, wall);
  for (auto& t : ball.triangles) std::swap(t.y, t.z);
  add_mesh(scene, std::move(ball));
  scene.lights.push_back(PointLight{V3f(0, 0, 0), Rgb(1, 2, 4)});
  return scene;
}

double area(const Scene& scene) {
  double sum = 0;
  for (const Mesh& mesh : scene.meshes) {
    for (const auto& t : mesh.triangles)
      sum += (V3d(mesh.positions[t.y]) - V3d(mesh.positions[t.x]))
                 .cross(V3d(mesh.positions[t.z]) - V3d(mesh.positions[t.x]))
                 .length() /
             2;
  }
  return sum;
}

// How far off E would be if the disc were counted wrongly: with the rim's photon 1/(K-1) too bright, without the photon
// at its centre about 1/K too dark. A mean that passes the z-test is within z_limit standard errors of the truth; with
// eight of them to 1/K the wrong mean is as many away again from passing.
//
// At K = 20 the hole around an estimate juts out of some discs. With its area A, in photons, exponentially distributed
// with mean 4, and three quarters of the photons left in it, the K-th photon's distance r from a point of its rim
// follows from
//   pi r^2 - (overlap of disc and hole)/4 ~ Gamma(K - 1),
// by which (K - 1)/(pi r^2) is 1.0 % too large on average (5 % at K = 10, nothing at 50; by simulation, +- 0.05 %).
void expect_even_light(const Accumulator& means, double light, int neighbours) {
  const double truth = light * (neighbours == 20 ? 1.01 : 1);
  EXPECT_LT(std::abs(z_score(means, truth)), z_limit)
      << "K = " << neighbours << ": " << means.mean() << " for " << truth;
  EXPECT_LT(means.standard_error(), truth / (2 * z_limit * neighbours)) << "K = " << neighbours;
}

// E = Phi/A rho/(1 - rho) everywhere. The means of maps of 24 seeds are independent; |z| > 4 is a false alarm once in
// 1,800 tests of a mean with 23 degrees of freedom.
TEST(PhotonMap, IntegratingSphere) {
  const LitScene lit = make_lit_scene(integrating_sphere(0.5F));
  const double flux = 4 * double(pi) * 2;  // of the green channel
  const double truth = flux / area(*lit.scene) * 0.5 / (1 - 0.5);
  for (const int neighbours : {20, 100}) {  // 50 are Furnace's
    Accumulator means;
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
      PhotonMapParams params;
      params.photons = 100'000;
      params.neighbours = neighbours;
      params.seed = seed;
      const PhotonMap map(lit, params);
      constexpr int places = 4000;
      double mean = 0;
      for (int i = 0; i < places; ++i) {  // along a spiral
        const float y = 1 - (2 * float(i) + 1) / places;
        const float angle = 2.3999632F * float(i);
        const float r = std::sqrt(1 - y * y);
        const V3f n(r * std::cos(angle), y, r * std::sin(angle));
        const Rgb e = map.irradiance(n, -n);
        mean += double(e.y) / places;
        EXPECT_NEAR(e.x, e.y / 2, 1e-4F * e.y);  // grey walls keep the light's colour
        EXPECT_NEAR(e.z, e.y * 2, 1e-4F * e.y);
      }
      means.add(mean);
    }
    expect_even_light(means, truth, neighbours);
  }
}

// Closed box whose walls emit L_e: indirect E = pi L_e rho/(1-rho), read at 24 x 24 places on each wall, no nearer to
// its edges than 0.2 m: the largest discs have a radius of 0.08 m.
TEST(PhotonMap, Furnace) {
  Scene scene;
  scene.name = "furnace";
  const int wall = add_lambert(scene, Rgb(0.6F, 0.6F, 0.6F), Rgb(2, 2, 2));
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), wall));
  const LitScene lit = make_lit_scene(std::move(scene));
  const double truth = double(pi) * 2 * 0.6 / (1 - 0.6);
  constexpr int side = 24;
  constexpr int neighbours = 50;
  Accumulator means;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    PhotonMapParams params;
    params.photons = 60'000;
    params.neighbours = neighbours;
    params.seed = seed;
    const PhotonMap map(lit, params);
    double mean = 0;
    for (unsigned face = 0; face < 6; ++face) {
      V3f n(0, 0, 0);
      n[face / 2] = face % 2 == 0 ? 1.0F : -1.0F;
      for (int i = 0; i < side * side; ++i) {
        V3f p = n;
        p[(face / 2 + 1) % 3] = 0.8F * (2 * (float(i % side) + 0.5F) / side - 1);
        p[(face / 2 + 2) % 3] = 0.8F * (2 * (float(i / side) + 0.5F) / side - 1);
        mean += double(map.irradiance(p, -n).y) / (6 * side * side);
      }
    }
    means.add(mean);
  }
  expect_even_light(means, truth, neighbours);
}

// Under a lamp the light is not even: the map's mean over the floor is still the path tracer's. The floor's middle
// 1 m^2, 4 cm discs: the light's curvature there is worth 0.1 %.
TEST(PhotonMap, AgreesWithThePathTracerInARoom) {
  Scene scene;
  scene.name = "room";
  const int white = add_lambert(scene, Rgb(0.7F, 0.7F, 0.7F));
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), white));
  scene.lights.push_back(PointLight{V3f(0.3F, 0.2F, -0.2F), Rgb(1, 1, 1)});
  const LitScene lit = make_lit_scene(std::move(scene));
  std::vector<ProbePoint> points;
  for (int i = 0; i < 64; ++i)
    points.push_back({V3f(-0.5F + float(i % 8) / 7, -1, -0.5F + float(i / 8) / 7), V3f(0, 1, 0)});
  ProbeParams probe;
  probe.samples = 2000;
  probe.indirect_only = true;
  double truth = 0;
  double truth_variance = 0;
  for (const ProbeResult& r : probe_scene(lit, points, probe)) {
    truth += double(r.e.y) / 64;
    truth_variance += std::pow(double(r.standard_error.y) / 64, 2);
  }
  Accumulator means;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    PhotonMapParams params;
    params.photons = 100'000;
    params.seed = seed;
    const PhotonMap map(lit, params);
    double mean = 0;
    for (const ProbePoint& point : points) mean += double(map.irradiance(point.p, point.n).y) / 64;
    means.add(mean);
  }
  const double error = std::hypot(means.standard_error(), std::sqrt(truth_variance)) + 1e-3 * truth;
  EXPECT_LT(std::abs(means.mean() - truth) / error, z_limit) << means.mean() << " for " << truth;
}

// Two sides of a thin wall hold light of their own, and what no photon reaches is black.
TEST(PhotonMap, KeepsSidesApart) {
  Scene scene;
  scene.name = "wall";
  const int white = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F), Rgb(0, 0, 0), true);
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), white));
  add_mesh(scene, make_quad(V3f(0, -1, -1), V3f(0, 2, 0), V3f(0, 0, 2), white));
  scene.lights.push_back(PointLight{V3f(0.5F, 0, 0), Rgb(1, 1, 1)});
  const LitScene lit = make_lit_scene(std::move(scene));
  PhotonMapParams params;
  params.photons = 20'000;
  const PhotonMap map(lit, params);
  EXPECT_GT(map.irradiance(V3f(0, 0.1F, 0.1F), V3f(1, 0, 0)).y, 0);
  EXPECT_EQ(map.irradiance(V3f(0, 0.1F, 0.1F), V3f(-1, 0, 0)), Rgb(0, 0, 0));
  EXPECT_EQ(map.irradiance(V3f(-1, 0, 0), V3f(1, 0, 0)), Rgb(0, 0, 0));
}

TEST(PhotonMap, DoesNotDependOnThreads) {
  const LitScene lit = make_lit_scene(small_room());
  std::vector<Rgb> results[2];
  for (const int threads : {1, 2}) {
    PhotonMapParams params;
    params.photons = 20'000;
    params.threads = threads;
    const PhotonMap map(lit, params);
    for (int i = 0; i < 100; ++i)
      results[threads - 1].push_back(map.irradiance(V3f(-0.9F + 0.018F * float(i), -1, 0.3F), V3f(0, 1, 0)));
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST(PhotonMap, ArrivalsEndTheSegments) {
  const LitScene lit = make_lit_scene(small_room());
  const PhotonTracer tracer(lit, {});
  std::vector<PhotonSegment> segments;
  std::vector<PhotonArrival> arrivals;
  PhotonLedger a;
  PhotonLedger b;
  tracer.trace(0, 2000, segments, a);
  tracer.trace_arrivals(0, 2000, arrivals, b);
  EXPECT_EQ(a.absorbed, b.absorbed);
  EXPECT_EQ(a.rays, b.rays);
  ASSERT_GT(arrivals.size(), 1000U);
  // The lamp is black and keeps no photons; all others are segments' ends, in order.
  std::size_t next = 0;
  for (const PhotonSegment& s : segments) {
    if (next == arrivals.size()) break;
    if ((s.origin + s.direction * s.length_m - arrivals[next].p).length() > 1e-5F) continue;
    EXPECT_EQ(s.power_lm, arrivals[next].power_lm);
    EXPECT_LT(s.direction.dot(arrivals[next].n), 0);
    ++next;
  }
  EXPECT_EQ(next, arrivals.size());
}

TEST(PhotonMap, RefusesDarknessAndEndlessMaps) {
  Scene dark;
  dark.name = "dark";
  add_mesh(dark, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), add_lambert(dark, Rgb(0.5F, 0.5F, 0.5F))));
  const LitScene unlit = make_lit_scene(std::move(dark));
  EXPECT_THROW(PhotonMap(unlit, {}), Error);
  const LitScene lit = make_lit_scene(small_room());
  PhotonMapParams params;
  params.photons = 100'000'000'000;
  EXPECT_THROW(PhotonMap(lit, params), Error);
}

}  // namespace
}  // namespace ivory
