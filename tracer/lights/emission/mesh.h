// What the triangles of an emissive mesh shine with, and where on them: made once for a mesh, whatever the number of
// its instances.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "tracer/core/sampler.h"
#include "tracer/lights/emission/map.h"

namespace ivory {

struct MeshEmission {
  int mesh = no_index;
  std::vector<Rgb> mean_radiance;          // [triangle]: nits, coverage included
  std::shared_ptr<const EmissionMap> map;  // null: points are chosen evenly
  // Sums of the map's weight times area (of barycentric coordinates) up to the end of each group of `rows_a_sum` rows
  // of cells, triangle after triangle; a triangle without any is chosen from evenly.
  std::vector<double> row_sums;
  std::vector<std::uint32_t> first_sum;  // [triangle + 1]
  int rows_a_sum = 1;
};

// One for each mesh whose material emits, null for the others. Textures are integrated exactly over each triangle:
// bilinear and nearest texels as they are looked up, coverage as it dims them (MASK edges inside a texel to a
// sixty-fourth of it). Throws Error (naming the scene) where memory does not suffice.
std::vector<std::unique_ptr<const MeshEmission>> make_mesh_emissions(const Scene& scene);

struct EmissionPoint {
  V2f barycentric;
  float density;  // of its choice, as a multiple of an even choice's
};

// A point of the triangle in proportion to what it emits, as far as texels go; evenly without a texture. Density 0
// where rounding has moved the point to where nothing is emitted.
EmissionPoint sample_point(const Scene& scene, const MeshEmission& emission, int triangle, RandomStream& random);

// The same with the first two random numbers given, in [0, 1): points of neighbouring u lie together.
EmissionPoint sample_point(const Scene& scene, const MeshEmission& emission, int triangle, const Imath::V2d& u,
                           RandomStream& random);

// Density of any point of the triangle.
float point_density(const Scene& scene, const MeshEmission& emission, int triangle, const V2f& barycentric);

}  // namespace ivory
