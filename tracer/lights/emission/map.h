// What a textured material emits, cell by cell of its texture, and sums of it along rows: so that the light of any
// triangle is integrated, and its bright texels are found, in a time that goes with the triangle's outline and not with
// its area in texels.
#pragma once

#include <optional>
#include <vector>

#include "tracer/lights/emission/cell_axis.h"

namespace ivory {

struct EmissionMap {
  const Scene* scene = nullptr;
  int material = no_index;
  TextureUse use;  // whose coordinates and texels the cells are of
  Imath::V2i texels{0, 0};
  CellAxis x;
  CellAxis y;
  // Radiance is a function of the cell: true unless coverage goes by other coordinates than emission.
  bool whole = true;
  std::vector<float> weights;  // [y.count][x.count]: cell_weight()
  std::vector<Rgb> radiances;  // the same of cell_radiance(); empty where texels tell: opaque and not joined to blocks
  // Sums before every 16th stored cell of a row, [y.count][blocks a row].
  std::vector<double> weight_sums;
  std::vector<V3d> radiance_sums;  // empty once forget_radiance() was called
};

// Of a material that emits by a texture or is covered by one; nothing for others. `join` (a power of two): cells along
// each axis that become one block, to bound the work of what repeats a texture very often. The scene must outlive it.
std::optional<EmissionMap> make_emission_map(const Scene& scene, int material, int join);

// Axes alone, without looking at texels: what a triangle's extent in cells is measured by.
std::optional<EmissionMap> make_emission_axes(const Scene& scene, int material);

// Density in which points of unbounded cell (i, j) are to be chosen: the mean of the sum of r, g and b, in nits, there
// and at least a sixteenth of its maximum, so that it is 0 only where nothing is emitted.
double cell_weight(const EmissionMap& map, int i, int j);
// Its sum over cells begin to end of row j.
double run_weight(const EmissionMap& map, int begin, int end, int j);
// The cell from begin to end at which the sum first exceeds `target`, at least 0 and less than the run's.
int find_in_run(const EmissionMap& map, int begin, int end, int j, double target);

// Mean radiance, nits, over unbounded cell (i, j), and its sum over a run of them. By whole maps only.
V3d cell_radiance(const EmissionMap& map, int i, int j);
V3d run_radiance(const EmissionMap& map, int begin, int end, int j);
// Radiance at a point of unbounded cell (i, j), x and y in cells. By maps of texels only.
V3d bilinear_radiance(const EmissionMap& map, int i, int j, double x, double y);
// What only integrals need.
void forget_radiance(EmissionMap& map);

// The unbounded cell that the look-up at a barycentric of a triangle takes its texels from.
Imath::V2i cell_at(const EmissionMap& map, const Mesh& mesh, int triangle, const V2f& barycentric);

}  // namespace ivory
