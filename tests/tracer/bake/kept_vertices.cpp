// Sparse storage: what is kept, and that nothing on a surface changes for it.
#include "tracer/bake/field/kept_vertices.h"

#include <cmath>

#include <gtest/gtest.h>

#include "grid/field/resolve.h"
#include "tools/stability/scene_builder.h"
#include "tracer/bake/field/baker.h"
#include "tracer/render/guard_rays.h"

namespace ivory {
namespace {

Scene tilted_square() {
  Scene scene;
  scene.name = "tilted square";
  const int white = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
  add_mesh(scene, make_quad(V3f(-1, -0.5F, -1), V3f(2, 0, 0), V3f(0, 1, 2), white));
  scene.lights.emplace_back(PointLight{V3f(0, 2, -1), Rgb(10, 10, 10)});
  return scene;
}

// A floor that reaches a million voxels past the grid keeps what one of twice the grid's size keeps: the cells beside
// it and, as for any surface outside, none more than those that are nearest.
TEST(KeptVertices, FloorsOfAnySizeKeepTheSame) {
  GridFrame frame;
  frame.size = V3i(24, 12, 20);
  frame.spacing_m = V3f(0.1F, 0.1F, 0.1F);
  frame.origin_m = V3f(-1.2F, 0.05F, -1);
  const auto kept_over = [&](float side_m) {
    Scene scene;
    const int white = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
    add_mesh(scene, make_quad(V3f(-side_m, 0, -side_m), V3f(0, 0, 2 * side_m), V3f(2 * side_m, 0, 0), white));
    return kept_vertices(scene, frame, {});
  };
  const auto small = kept_over(5);
  EXPECT_EQ(kept_over(1e5F), small);
  for (std::size_t v = 0; v < small.size(); ++v)
    EXPECT_EQ(small[v], frame.vertex_coordinates(v).y <= guard_band_voxels);
}

// Against distances to the plane, for every vertex.
TEST(KeptVertices, BandAroundATiltedSquare) {
  const Scene scene = tilted_square();
  GridFrame frame;
  frame.size = V3i(40, 40, 40);
  frame.spacing_m = V3f(0.05F, 0.05F, 0.05F);
  frame.origin_m = V3f(-0.975F, -0.975F, -0.975F);
  const auto kept = kept_vertices(scene, frame, {});
  const V3f n = V3f(0, -2, 1).normalized();
  int count = 0;
  for (int k = 0; k < 40; ++k) {
    for (int j = 0; j < 40; ++j) {
      for (int i = 0; i < 40; ++i) {
        const float distance = std::abs(n.dot(frame.to_world(V3f(V3i(i, j, k))))) / 0.05F;
        const bool is_kept = kept[frame.vertex_index(i, j, k)];
        // A cube of 3 voxels around a cell that the plane passes: nearer than 3 in Euclid's sense is inside,
        // farther than the half diagonal of 3.5 plus half a voxel's is outside.
        if (distance < guard_band_voxels) {
          EXPECT_TRUE(is_kept);
        }
        if (distance > 4 * std::sqrt(3.0F)) {
          EXPECT_FALSE(is_kept);
        }
        count += is_kept ? 1 : 0;
      }
    }
  }
  EXPECT_LT(count, 40 * 40 * 40 / 2);
  Box3f region(V3f(0.5F, 0.8F, -0.9F), V3f(0.6F, 0.9F, -0.8F));
  const auto with_region = kept_vertices(scene, frame, {region});
  const V3f inside = frame.to_index(V3f(0.55F, 0.85F, -0.85F));
  const std::size_t vertex = frame.vertex_index(int(inside.x), int(inside.y), int(inside.z));
  EXPECT_FALSE(kept[vertex]);
  EXPECT_TRUE(with_region[vertex]);
}

TEST(KeptVertices, SurfacesReadTheSame) {
  const LitScene lit = make_lit_scene(tilted_square());
  GridBakeParams params;
  params.resolution = V3i(20, 20, 20);
  params.photons = 20'000;
  params.include_direct = true;
  const IrradianceGrid full = resolve(bake_grid_sums(lit, params));
  params.dynamic_regions.emplace();
  const IrradianceGrid sparse = resolve(bake_grid_sums(lit, params));
  const V3f n = V3f(0, 2, -1).normalized();
  for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::tricubic}) {
    LookupParams lookup;
    lookup.interpolation = interpolation;
    for (const Guard guard : {Guard::off, Guard::planes, Guard::rays}) {
      lookup.guard = guard;
      for (int i = 0; i < 50; ++i) {
        const float s = 0.02F * float(i);
        const V3f p(-1 + 2 * s, -0.5F + s, -1 + 2 * s);
        EXPECT_EQ(lookup_irradiance(full, &lit.intersector, p, n, n, lookup),
                  lookup_irradiance(sparse, &lit.intersector, p, n, n, lookup));
      }
    }
  }
}

}  // namespace
}  // namespace ivory
