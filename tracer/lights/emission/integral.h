// The light of a textured triangle, and the weights by which points on it are chosen.
#pragma once

#include "tracer/lights/emission/map.h"
#include "tracer/lights/emission/texel_polygon.h"

namespace ivory {

// What leaves a mesh's triangle at a barycentric, nits: emission times coverage, because a hit ray meets a BLEND or
// MASK surface with just that probability.
Rgb covered_emission_at(const Scene& scene, int mesh, int triangle, const V2f& barycentric);

// Its mean over the triangle by the centroid rule over n^2 equal triangles, their edges no longer than a texel where
// n up to `most_steps` allows: for what has no texture (vertex colours may cover it), and for what is too far out for
// texels to be told apart. Not black where a corner shines.
Rgb sampled_mean(const Scene& scene, int mesh, int triangle, int most_steps);

// The triangle in cells; empty where its coordinates are not finite or too far out.
TexelPolygon polygon_of(const EmissionMap& map, const Mesh& mesh, int triangle);

// Barycentric area of a cell that the triangle covers whole.
double cell_area(const TexelPolygon& triangle);

// Light of triangles by a map that still has its radiance. What it refers to must outlive it.
class EmissionIntegrator {
 public:
  EmissionIntegrator(const Scene& scene, int mesh, const EmissionMap& map);

  struct Row {
    double weight;  // cell_weight() times barycentric area
    V3d light;      // nits times barycentric area
  };
  // Of the cells in row j of a triangle given by polygon_of(); `whole_cell` is its cell_area().
  Row row(const TexelPolygon& polygon, double whole_cell, int triangle, int j) const;

 private:
  V3d piece(const TexelPolygon& part, int triangle, int i, int j) const;

  const Scene& scene_;
  int mesh_;
  const EmissionMap& map_;
  const Material& material_;
  bool opaque_;
  bool by_cell_;    // radiance is a function of the cell
  bool joined_;     // cells are blocks
  bool same_size_;  // alpha is bilinear in a cell, too
};

}  // namespace ivory
