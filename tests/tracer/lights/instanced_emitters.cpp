// Emissive meshes placed thousands of times against as many meshes: the same light, in the memory of one.
#include <cmath>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tests/support/emissive_texture.h"
#include "tests/support/lights_check.h"
#include "tracer/core/sampling.h"

namespace ivory {
namespace {

// Turned, stretched and mirrored by turns, on a lattice of 1 m.
M44f place(int i) {
  M44f m;
  m.rotate(V3f(0.1F * float(i), 0.3F * float(i), 0));
  M44f scale;
  scale.setScale(V3f(i % 3 == 0 ? -0.5F : 0.5F, 0.2F + 0.1F * float(i % 5), 0.3F));
  m = scale * m;
  m[3][0] = float(i % 50 - 25);
  m[3][1] = 4 + float(i % 7);
  m[3][2] = float(i / 50 - 25);
  return m;
}

Scene lamps(int count, bool instanced) {
  Scene scene;
  const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(10, 5, 1), true);
  scene.materials[0].emission_texture.texture = add_texture(scene, 4, 2, [](int x, int y) {
    return Texel{std::uint8_t(60 * x), std::uint8_t(x == y ? 255 : 0), 90, 255};
  });
  Mesh mesh = make_quad({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, lamp);
  mesh.positions[2].y = 0.5F;  // two normals
  for (int i = 0; i < count; ++i) {
    if (instanced && i > 0) {
      scene.instances.push_back({0, place(i)});
    } else {
      add_mesh(scene, mesh, place(i));
    }
  }
  return scene;
}

TEST(InstancedEmitters, ShineAsTheirCopiesDo) {
  constexpr int count = 2500;  // 5,000 triangles: more than are held one by one
  const LitScene shared = make_lit_scene(lamps(count, true));
  const LitScene copies = make_lit_scene(lamps(count, false));
  const Rgb power = copies.lights.total_power_lm();
  expect_power_and_photons_agree(shared.lights, power, "instanced");
  for (const V3f& n : {V3f(0, 1, 0), V3f(1, 0.2F, 0).normalized()}) {
    const Accumulator a = irradiance_samples(shared.lights, {0.3F, 0, 0.2F}, n, 50000);
    const Accumulator b = irradiance_samples(copies.lights, {0.3F, 0, 0.2F}, n, 50000);
    EXPECT_LT(std::abs(z_score(a, b)), z_limit);
    // Stretching makes no more than a little noise.
    EXPECT_LT(a.standard_error(), 1.5 * b.standard_error());
  }
  const Lights::PhotonPower range = shared.lights.photon_power();
  EXPECT_LT(range.strongest_lm, 2.001F * max_component(power));
}

TEST(InstancedEmitters, DensityMatchesTheirSamples) {
  const LitScene lit = make_lit_scene(lamps(2500, true));
  RandomStream random = test_stream();
  int checked = 0;
  for (int i = 0; i < 2000; ++i) {
    const V3f p = sample_sphere(random.next2()) * 1.5F;
    const auto s = lit.lights.sample(p, random);
    if (!s) continue;
    Ray ray;
    ray.origin = p;
    ray.direction = s->w;
    const auto hit = lit.intersector.closest(ray);
    // Others may stand before it.
    if (!hit || std::abs(hit->t - s->distance_m) > 1e-4F * s->distance_m) continue;
    const float cosine = std::abs(hit->ng.dot(s->w));
    if (cosine < 0.05F || std::abs(hit->ng.dot(s->ng)) < 0.9999F) continue;  // where the hit's rounding counts
    const float pdf = lit.lights.pdf_solid_angle(p, *hit);
    // Within 1e-4 of a texel's edge the hit may have another cell's density.
    if (std::abs(pdf - s->pdf_solid_angle) < 2e-3F * s->pdf_solid_angle)
      ++checked;
    else
      ADD_FAILURE() << pdf << " " << s->pdf_solid_angle;
  }
  EXPECT_GT(checked, 300);
}

// 4,000 spheres of 2,048 triangles: tables by the placed triangle would take 1.6 GB.
TEST(InstancedEmitters, TakeTheMemoryOfOneMesh) {
  Scene scene;
  const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(1, 1, 1));
  add_mesh(scene, make_inward_sphere(4, lamp));
  scene.instances.clear();
  for (int i = 0; i < 4000; ++i) {
    M44f m;
    m.setScale(V3f(0.1F, 0.1F, 0.1F));
    m[3][0] = float(i % 63);
    m[3][2] = float(i / 63);
    scene.instances.push_back({0, m});
  }
  rusage before{};
  getrusage(RUSAGE_SELF, &before);
  const LitScene lit = make_lit_scene(std::move(scene));
  rusage after{};
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 100'000);  // KiB, Embree's 4,000 instances included
  double area = 0;
  const Mesh& mesh = lit.scene->meshes[0];
  for (const auto& t : mesh.triangles) {
    const V3d a(mesh.positions[t.x]);
    area += 0.5 * (V3d(mesh.positions[t.y]) - a).cross(V3d(mesh.positions[t.z]) - a).length();
  }
  EXPECT_NEAR(lit.lights.total_power_lm().x, 4000 * double(pi) * area * 0.01, 1e-4 * 4000);
}

}  // namespace
}  // namespace ivory
