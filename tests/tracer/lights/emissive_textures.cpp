// Emissive textures: their light over triangles against fine quadratures and closed forms, wherever on the texture the
// triangle lies and however few of its texels shine, and the points chosen on them.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grid/field/resolve.h"
#include "tests/support/emissive_texture.h"
#include "tests/support/lights_check.h"
#include "tracer/bake/field/baker.h"
#include "tracer/core/sampling.h"
#include "tracer/lights/emission/integral.h"
#include "tracer/lights/emission/mesh.h"
#include "tracer/render/probe.h"

namespace ivory {
namespace {

// The slow twin: the centroid rule over n^2 equal triangles.
template <typename Value>
V3d mean_over_triangle(int n, const Value& value) {
  V3d sum(0, 0, 0);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n - i; ++j) {
      sum += V3d(value(V2f(float(i) + 1.0F / 3, float(j) + 1.0F / 3) / float(n)));
      if (j < n - i - 1) sum += V3d(value(V2f(float(i) + 2.0F / 3, float(j) + 2.0F / 3) / float(n)));
    }
  }
  return sum / (double(n) * n);
}

Texel random_texel(int x, int y) {
  const auto byte = [&](int channel) {
    const unsigned h = (unsigned(x) * 73U + unsigned(y) * 151U + unsigned(channel) * 37U + 11U) * 2654435761U;
    return std::uint8_t((h >> 13U) % 3 == 0 ? 0 : h >> 24U);
  };
  return {byte(0), byte(1), byte(2), byte(3)};
}

struct Case {
  std::string name;
  std::vector<V2f> uvs;  // of the triangle's corners
};

const std::vector<Case> cases{
    {"whole", {{0, 0}, {2, 0}, {0, 2}}},
    {"half", {{0, 0}, {1, 0}, {1, 1}}},
    {"mirrored and rotated", {{0.9F, 0.1F}, {0.1F, 0.3F}, {0.4F, 0.95F}}},
    {"repeated", {{-1.3F, -0.7F}, {2.4F, 0.2F}, {0.3F, 3.1F}}},
    {"far outside", {{12.2F, -7.1F}, {13.1F, -7.3F}, {12.4F, -6.2F}}},
    {"within a texel", {{0.31F, 0.42F}, {0.33F, 0.43F}, {0.32F, 0.46F}}},
    {"a line", {{0.1F, 0.2F}, {0.9F, 0.7F}, {0.5F, 0.45F}}},
    {"along a row", {{0.1F, 0.25F}, {1.7F, 0.25F}, {0.6F, 0.25F}}},
    {"a point", {{0.57F, 0.63F}, {0.57F, 0.63F}, {0.57F, 0.63F}}},
};

Scene triangle_scene(const std::vector<V2f>& uvs) {
  Scene scene;
  const int lamp = add_lambert(scene, Rgb(0, 0, 0), Rgb(10, 5, 1));
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  mesh.triangles.emplace_back(0, 1, 2);
  mesh.uvs = {uvs};
  mesh.material = lamp;
  add_mesh(scene, mesh);
  return scene;
}

// Points chosen fall as point_density() says, which is 1 in the mean, and is where light is.
void expect_density_of_points(const Scene& scene, const MeshEmission& emission, const std::string& label) {
  constexpr int side = 12;
  constexpr int samples = 4000;
  const auto bin = [](const V2f& b) {
    return std::size_t(std::min(int(b.x * side), side - 1) * side + std::min(int(b.y * side), side - 1));
  };
  std::vector<double> expected(side * side, 0);
  double least_missed = 0;
  const V3d mean = mean_over_triangle(120, [&](const V2f& b) {
    const float density = point_density(scene, emission, 0, b);
    expected[bin(b)] += double(density) * samples / (120.0 * 120.0);
    if (density == 0) least_missed += double(max_component(covered_emission_at(scene, 0, 0, b)));
    return Rgb(density, 0, 0);
  });
  // Cells' edges cut the rule's triangles.
  EXPECT_NEAR(mean.x, 1, 0.03) << label;
  EXPECT_EQ(least_missed, 0) << label;
  std::vector<double> counts(side * side, 0);
  RandomStream random = test_stream();
  Accumulator light;
  for (int i = 0; i < samples; ++i) {
    const EmissionPoint point = sample_point(scene, emission, 0, random);
    if (!(point.density > 0)) continue;
    ASSERT_EQ(point.density, point_density(scene, emission, 0, point.barycentric)) << label;
    counts[bin(point.barycentric)] += 1;
    light.add(double(covered_emission_at(scene, 0, 0, point.barycentric).x / point.density));
  }
  // The expected counts are good to 1 % a bin, which adds 0.3 to the score.
  EXPECT_LT(chi_square_score(counts, expected), 4.5) << label;
  EXPECT_LE(std::abs(light.mean() - double(emission.mean_radiance[0].x)),
            z_limit * light.standard_error() + 1e-3 * light.mean())
      << label << ": " << light.mean() << " +- " << light.standard_error();
}

TEST(EmissiveTextures, AreIntegratedOverTheTriangle) {
  for (const bool nearest : {false, true}) {
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge}) {
      for (const Case& place : cases) {
        Scene scene = triangle_scene(place.uvs);
        scene.materials[0].emission_texture.texture = add_texture(scene, 7, 5, random_texel, nearest, wrap, wrap);
        const std::string label = place.name + (nearest ? ", nearest " : ", bilinear ") + std::to_string(int(wrap));
        const auto emissions = make_mesh_emissions(scene);
        const V3d truth = mean_over_triangle(150, [&](const V2f& b) { return covered_emission_at(scene, 0, 0, b); });
        for (int c = 0; c < 3; ++c) {
          // Steps of nearest texels cut the rule's triangles, edges of bilinear ones bend in them.
          EXPECT_NEAR(emissions[0]->mean_radiance[0][c], truth[c], nearest ? 0.05 : 3e-3 * truth[c] + 1e-3)
              << label << " " << c;
        }
        if (is_black(emissions[0]->mean_radiance[0])) continue;
        expect_density_of_points(scene, *emissions[0], label);
        // In proportion to r + g + b: exactly for nearest texels, within what bilinear ones vary in a cell.
        const Rgb& mean = emissions[0]->mean_radiance[0];
        RandomStream random = test_stream(1);
        for (int i = 0; i < 200; ++i) {
          const V2f b = sample_triangle(random.next2());
          const Rgb here = covered_emission_at(scene, 0, 0, b);
          const float ratio = (here.x + here.y + here.z) / (mean.x + mean.y + mean.z);
          const float density = point_density(scene, *emissions[0], 0, b);
          if (nearest) {
            ASSERT_NEAR(density, ratio, 1e-3F * ratio) << label;
          }
          ASSERT_LE(ratio, 4.001F * density) << label;
        }
      }
    }
  }
}

// Coverage by the same coordinates, at another size, turned, by vertices, alone; blended and cut.
TEST(EmissiveTextures, CoverageDimsThem) {
  for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask}) {
    for (const std::string kind : {"same", "finer", "turned", "vertices", "alone"}) {
      Scene scene = triangle_scene(cases[3].uvs);
      Material& lamp = scene.materials[0];
      lamp.alpha_mode = mode;
      if (kind != "alone") lamp.emission_texture.texture = add_texture(scene, 7, 5, random_texel);
      lamp.base_color_texture.texture =
          kind == "finer" ? add_texture(scene, 16, 9, random_texel) : add_texture(scene, 7, 5, random_texel);
      if (kind == "turned") lamp.base_color_texture.uv_transform = {0.6F, -0.8F, 0.1F, 0.8F, 0.6F, 0};
      if (kind == "vertices") scene.meshes[0].colors = {{1, 1, 1, 1}, {1, 1, 1, 0.3F}, {1, 1, 1, 0.8F}};
      const std::string label = kind + (mode == AlphaMode::mask ? ", mask" : ", blend");
      const auto emissions = make_mesh_emissions(scene);
      const double truth = mean_over_triangle(300, [&](const V2f& b) { return covered_emission_at(scene, 0, 0, b); }).x;
      EXPECT_NEAR(emissions[0]->mean_radiance[0].x, truth, (mode == AlphaMode::mask ? 0.01 : 2e-3) * truth) << label;
      // What has no say in the choice of points adds to their noise alone.
      expect_density_of_points(scene, *emissions[0], label);
    }
  }
}

// A sign: 16 texels of 4096 x 4096 shine, a stripe, and all: 1000 lm each.
TEST(EmissiveTextures, FewLitTexelsHaveTheirLight) {
  constexpr int side = 4096;
  const auto lit = [](int x, int y) { return x % 1024 == 700 && y % 1024 == 300; };
  const float flux = 1000;
  const float all_nits = flux / pi;
  for (const std::string kind : {"sign", "stripe", "even"}) {
    Scene scene;
    const auto shines = [&](int x, int y) {
      return kind == "even" || (kind == "sign" && lit(x, y)) || (kind == "stripe" && x == 77);
    };
    const int size = kind == "sign" ? side : 256;
    const int texture = add_texture(scene, size, size, [&](int x, int y) {
      return shines(x, y) ? Texel{255, 255, 255, 255} : Texel{0, 0, 0, 255};
    });
    const float share = kind == "sign" ? 0x1p-20F : kind == "stripe" ? 1.0F / 256 : 1.0F;
    add_panel(scene, 2, texture, Rgb(1, 1, 1) * (all_nits / share));
    const LitScene world = in_black_box(std::move(scene));
    EXPECT_NEAR(world.lights.total_power_lm().x, flux, 1e-4F * flux) << kind;
    if (kind != "sign") continue;

    // Each texel is a point: E = sum of L A cos cos / r^2.
    const auto vector_at = [&](const V3d& p) {
      V3d f(0, 0, 0);
      for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 4; ++k) {
          const V3d q((i * 1024 + 700.5) / side - 0.5, 2, (k * 1024 + 300.5) / side - 0.5);
          const V3d d = q - p;
          f += d * (double(flux) / 16 / double(pi) * d.y / std::pow(d.length(), 4));
        }
      }
      return f;
    };
    ProbeParams params;
    params.samples = 2000;
    const ProbeResult e = probe_scene(world, {{V3f(0.1F, 0, 0.2F), V3f(0, 1, 0)}}, params)[0];
    const double truth = vector_at(V3d(0.1, 0, 0.2)).y;
    EXPECT_NEAR(double(e.e.x), truth, z_limit * double(e.standard_error.x) + 1e-4 * truth);
    EXPECT_LT(e.standard_error.x, 0.02F * float(truth));

    // By photons, over a box: the vector to it is the same as the points' there, averaged.
    Accumulator photons;
    GridBakeParams bake;
    bake.frame = centred_frame(2, 0.6F);
    bake.photons = 20000;
    bake.guard = Guard::off;
    bake.include_direct = true;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      bake.seed = seed;
      const IrradianceGrid grid = resolve(bake_grid_sums(world, bake));
      double mean = 0;
      for (std::size_t vertex = 0; vertex < 8; ++vertex) mean += double(grid.at(vertex)[3]) / 8;
      photons.add(mean);
    }
    double box = 0;
    for (int i = 0; i < 1000; ++i)
      box += vector_at(V3d(i % 10 - 4.5, i / 10 % 10 - 4.5, i / 100 - 4.5) * 0.06).y / 1000;
    // Ten points a side are good to 1e-4.
    EXPECT_LT(std::abs(photons.mean() - box), z_limit * photons.standard_error() + 1e-3 * box)
        << photons.mean() << " +- " << photons.standard_error() << ", " << box;
  }
}

// Letters cut out of a sheet that shines evenly.
TEST(EmissiveTextures, FewCoveredTexelsHaveTheirLight) {
  for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask}) {
    Scene scene;
    const int texture = add_texture(
        scene, 512, 512,
        [](int x, int y) {
          return Texel{255, 255, 255, std::uint8_t(x == 99 && y == 400 ? 255 : 0)};
        },
        true);
    add_panel(scene, 2, no_index, Rgb(1, 1, 1) * (512.0F * 512.0F * 1000 / pi));
    scene.materials[0].base_color_texture.texture = texture;
    scene.materials[0].alpha_mode = mode;
    const LitScene world = in_black_box(std::move(scene));
    EXPECT_NEAR(world.lights.total_power_lm().x, 1000, 0.1);
    RandomStream random = test_stream();
    for (int i = 0; i < 1000; ++i) {
      ASSERT_NEAR(world.lights.emit(random).power.x, 1000, 1);
      const auto s = world.lights.sample({0, 0, 0}, random);
      ASSERT_TRUE(s);
      ASSERT_NEAR(s->point.x, 99.5F / 512 - 0.5F, 0.51F / 512);
    }
  }
}

// Splitting triangles until many share a texel leaves the power where it was.
TEST(EmissiveTextures, SmallTrianglesShareATexel) {
  const auto power = [](int split) {
    Scene scene;
    const int material = add_lambert(scene, Rgb(0, 0, 0), Rgb(100, 100, 100));
    scene.materials[0].emission_texture.texture = add_texture(scene, 9, 9, random_texel);
    Mesh mesh;
    mesh.material = material;
    mesh.uvs.resize(1);
    for (int i = 0; i <= split; ++i) {
      for (int k = 0; k <= split; ++k) {
        const V2f uv(float(i) / float(split), float(k) / float(split));
        mesh.positions.emplace_back(uv.x, 2.0F, uv.y);
        mesh.uvs[0].push_back(uv * 1.7F - V2f(0.3F, 0.3F));
      }
    }
    const auto at = [&](int i, int k) { return std::uint32_t(i * (split + 1) + k); };
    for (int i = 0; i < split; ++i) {
      for (int k = 0; k < split; ++k) {
        mesh.triangles.emplace_back(at(i, k), at(i + 1, k), at(i + 1, k + 1));
        mesh.triangles.emplace_back(at(i, k), at(i + 1, k + 1), at(i, k + 1));
      }
    }
    add_mesh(scene, mesh);
    return in_black_box(std::move(scene)).lights.total_power_lm();
  };
  const Rgb whole = power(1);
  const Rgb parts = power(100);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(parts[c], whole[c], 1e-4F * whole[c]);
}

// Repeated so often that cells are joined: power and density still hold.
TEST(EmissiveTextures, FarRepeatedOnesAreJoined) {
  Scene scene = triangle_scene({{-666.3F, 0}, {520, 17}, {100, 1040}});
  scene.materials[0].emission_texture.texture = add_texture(scene, 1024, 1000, [](int x, int y) {
    return x == 500 && y % 500 == 200 ? Texel{255, 255, 255, 255} : Texel{0, 0, 0, 255};
  });
  const auto emissions = make_mesh_emissions(scene);
  ASSERT_LT(emissions[0]->map->x.cells_a_texel, 1);
  // 600,000 periods: the outline cuts 3e-3 of them.
  EXPECT_NEAR(emissions[0]->mean_radiance[0].x, 10.0 * 2 / 1024 / 1000, 3e-3 * 10 * 2 / 1024 / 1000);
  RandomStream random = test_stream();
  for (int i = 0; i < 100; ++i) EXPECT_GT(sample_point(scene, *emissions[0], 0, random).density, 1);
}

// Beyond what float tells texels apart by, and a corner that vertices alone make visible: no light is dropped.
TEST(EmissiveTextures, WhatShinesIsNotDropped) {
  Scene far = triangle_scene({{3e7F, 3e7F}, {4e7F, 3e7F}, {3e7F, 5e7F}});
  far.materials[0].emission_texture.texture = add_texture(far, 64, 64, [](int x, int y) {
    return x == 9 && y == 9 ? Texel{255, 255, 255, 255} : Texel{0, 0, 0, 255};
  });
  EXPECT_GT(make_mesh_emissions(far)[0]->mean_radiance[0].x, 0);
  Scene corner = triangle_scene(cases[0].uvs);
  corner.materials[0].alpha_mode = AlphaMode::mask;
  corner.materials[0].alpha_cutoff = 0.99F;
  corner.meshes[0].colors = {{1, 1, 1, 1}, {1, 1, 1, 0}, {1, 1, 1, 0}};
  EXPECT_GT(make_mesh_emissions(corner)[0]->mean_radiance[0].x, 0);
  corner.meshes[0].colors[0].w = 0.5F;
  EXPECT_EQ(make_mesh_emissions(corner)[0]->mean_radiance[0].x, 0);
}

}  // namespace
}  // namespace ivory
