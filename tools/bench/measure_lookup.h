// What a look-up of E(p, n) in a grid costs, with each leak guard.
#pragma once

#include <vector>

#include "grid/field/irradiance_grid.h"
#include "tracer/core/intersector.h"

namespace ivory {

// Where random lines through the grid's box meet surfaces: at most `count` points, in random order, with unit normals.
struct SurfacePoints {
  std::vector<V3f> p;
  std::vector<V3f> n;
};
SurfacePoints surface_points(const GridFrame& frame, const Intersector& intersector, int count);

// Nanoseconds a point.
struct LookupFigure {
  double single_ns = 0;   // one after the other: grid/field/lookup.h
  double batched_ns = 0;  // many at once: grid/field/batch/lookup.h
};

struct LookupBench {
  LookupFigure off;
  LookupFigure planes;
  LookupFigure rays;
  double occlusion_ray_ns = 0;  // one Embree occlusion query as long as a voxel, for comparison
};

// Median over `rounds` of the time per look-up on one thread, at `lookups` points on the scene's surfaces
// in random order. `grid` must hold the scene's bake; Throws Error for a scene without surfaces.
LookupBench bench_lookup(const IrradianceGrid& grid, const Intersector& intersector, const LookupParams& lookup,
                         int lookups = 100'000, int rounds = 7);

}  // namespace ivory
