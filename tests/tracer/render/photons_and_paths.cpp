// Photons and paths carry the same light: two tracers that share only lights and BSDF, one following
// light from its sources, the other from the receiver, measured in mid-air. Where one of them treats a
// material, a side or a density wrongly, they part.
//
// Compared is the irradiance vector F = integral of L w dw, for which E(n) - E(-n) = n.F holds exactly:
// averaged over a box, the grid's cells give it without error of reconstruction.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grid/field/resolve.h"
#include "tests/support/statistics.h"
#include "tools/stability/scene_builder.h"
#include "tracer/bake/field/baker.h"
#include "tracer/render/probe.h"

namespace ivory {
namespace {

constexpr float side_m = 0.6F;

// F over the box, [axis][rgb], by photons: the cells of 2 x 2 x 2 vertices tile it.
std::vector<Accumulator> by_photons(const LitScene& lit, const V3f& low, bool direct) {
  std::vector<Accumulator> result(9);
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    GridBakeParams params;
    GridFrame frame;
    frame.size = V3i(2, 2, 2);
    frame.spacing_m = V3f(side_m, side_m, side_m) / 2;
    frame.origin_m = low + frame.spacing_m / 2;
    params.frame = frame;
    params.photons = 30'000;
    params.guard = Guard::off;
    params.include_direct = direct;
    params.seed = seed;
    const IrradianceGrid grid = resolve(bake_grid_sums(lit, params));
    for (std::size_t i = 0; i < 9; ++i) {
      double mean = 0;
      for (std::size_t vertex = 0; vertex < 8; ++vertex) mean += double(grid.at(vertex)[i]) / 8;
      result[i].add(mean);
    }
  }
  return result;
}

std::vector<Accumulator> by_paths(const LitScene& lit, const V3f& low, bool direct) {
  RandomStream random(3, StreamPurpose::test, 0);
  std::vector<ProbePoint> points;
  constexpr int count = 1500;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < count; ++i) {
      V3f n(0, 0, 0);
      n[axis] = 1;
      const V3f p = low + V3f(random.next(), random.next(), random.next()) * side_m;
      points.push_back({p, n});
      points.push_back({p, -n});
    }
  }
  ProbeParams params;
  params.samples = 32;
  params.indirect_only = !direct;
  const std::vector<ProbeResult> e = probe_scene(lit, points, params);
  std::vector<Accumulator> result(9);
  for (std::size_t i = 0; i < points.size(); i += 2) {
    const std::size_t axis = i / (2 * count);
    for (std::size_t c = 0; c < 3; ++c) result[axis * 3 + c].add(double(e[i].e[int(c)]) - double(e[i + 1].e[int(c)]));
  }
  return result;
}

void expect_agreement(Scene scene, const V3f& low) {
  const LitScene lit = make_lit_scene(std::move(scene));
  for (const bool direct : {false, true}) {
    const auto photons = by_photons(lit, low, direct);
    const auto paths = by_paths(lit, low, direct);
    for (std::size_t i = 0; i < 9; ++i) {
      EXPECT_LT(std::abs(z_score(photons[i], paths[i])), z_limit)
          << "axis " << i / 3 << " channel " << i % 3 << " direct " << direct << ": " << photons[i].mean() << " +- "
          << photons[i].standard_error() << ", " << paths[i].mean() << " +- " << paths[i].standard_error();
      EXPECT_GT(std::abs(photons[i].mean()), 0);
    }
  }
}

TEST(PhotonsAndPaths, AgreeInAGlossyRoom) {
  Scene scene = small_room();
  scene.lights.push_back(SpotLight{V3f(0.8F, 0.8F, 0.8F), V3f(-1, -1, -0.5F).normalized(), Rgb(1, 3, 2), 0.2F, 0.6F});
  Material gold;
  gold.base_color = Rgb(1, 0.77F, 0.34F);
  gold.roughness = 0.35F;
  scene.materials.push_back(gold);
  add_mesh(scene, make_quad({-0.99F, -0.8F, -0.8F}, {0, 1.6F, 0}, {0, 0, 1.6F}, 3));  // left wall, looks to +x
  expect_agreement(std::move(scene), V3f(-0.7F, -0.3F, -0.2F));
}

// Normals bent by up to 35 degrees: photons need the adjoint's correction, which paths do without.
TEST(PhotonsAndPaths, AgreeWithInterpolatedNormals) {
  Scene scene = small_room();
  scene.lights.push_back(SpotLight{V3f(0.8F, 0.8F, 0.8F), V3f(-1, -1, -0.5F).normalized(), Rgb(1, 3, 2), 0.2F, 0.6F});
  const int matt = add_lambert(scene, Rgb(0.9F, 0.8F, 0.7F));
  Mesh bent = make_quad({-0.9F, -0.9F, -0.9F}, {0, 0, 1.8F}, {1.8F, 0, 0}, matt);  // above the floor, looks up
  bent.normals = {V3f(0.7F, 1, 0).normalized(), V3f(0, 1, 0.6F).normalized(), V3f(-0.5F, 1, 0.5F).normalized(),
                  V3f(0.2F, 1, -0.7F).normalized()};
  add_mesh(scene, bent);
  expect_agreement(std::move(scene), V3f(-0.3F, -0.7F, -0.2F));
}

// An open scene: environment, sun, a blended sheet, a textured and mirrored lamp that shines from both sides.
TEST(PhotonsAndPaths, AgreeUnderTheSky) {
  Scene scene;
  const int grey = add_lambert(scene, Rgb(0.6F, 0.5F, 0.4F));
  const int sheet = add_lambert(scene, Rgb(0.9F, 0.2F, 0.2F), Rgb(0, 0, 0), true);
  scene.materials[std::size_t(sheet)].alpha_mode = AlphaMode::blend;
  scene.materials[std::size_t(sheet)].alpha = 0.6F;
  const int lamp = add_lambert(scene, Rgb(0.1F, 0.1F, 0.1F), Rgb(4, 6, 8), true);
  Image image;
  image.width = 2;
  image.height = 1;
  image.rgba = {255, 128, 0, 255, 0, 64, 255, 255};
  scene.images.push_back(image);
  Texture texture;
  texture.image = 0;
  scene.textures.push_back(texture);
  scene.materials[std::size_t(lamp)].emission_texture.texture = 0;
  add_mesh(scene, make_quad({-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, grey));     // floor, looks up
  add_mesh(scene, make_quad({-1, -1, -1}, {2, 0, 0}, {0, 1.5F, 0}, grey));  // back wall, looks to +z
  add_mesh(scene, make_quad({-1, 0.7F, -1}, {1.2F, 0, 0}, {0, 0, 1.5F}, sheet));
  M44f mirror;
  mirror.setScale(V3f(-1, 1, 1));
  add_mesh(scene, make_quad({-0.8F, -0.7F, -0.3F}, {0, 0.6F, 0}, {0, 0, 0.6F}, lamp), mirror);
  scene.lights.push_back(DirectionalLight{V3f(0.3F, -1, -0.4F).normalized(), Rgb(2, 1.5F, 1)});
  EnvironmentMap map = uniform_environment({0.3F, 0.4F, 0.5F}, 8);
  for (int i = 0; i < 16; ++i) map.radiance[std::size_t(32 + i)] = Rgb(1, 1, 1) * float(i);
  scene.environment = map;
  expect_agreement(std::move(scene), V3f(-0.3F, -0.4F, -0.5F));
}

}  // namespace
}  // namespace ivory
