// The rival of photons that people use: each vertex of the grid as a light probe of its own, paths traced from it over
// the sphere of directions, as engines' bakers do. The same vertices, bases, guard and files.
#pragma once

#include "tracer/bake/field/grid_params.h"
#include "tracer/core/lit_scene.h"

namespace ivory {

inline constexpr int default_probe_rays = 512;
// Whole powers of two cover the sphere most evenly; more are no probe's.
inline constexpr int max_probe_rays = 1 << 24;

// Moments of the indirect light that comes to each vertex that stores any: from `rays` directions a vertex, spread
// evenly over the sphere, each a path with light sampled at every surface that it meets. Photons measure the mean over
// what a vertex sees of its cell; this is the light at the vertex itself. Of `params` it takes where the grid stands,
// basis, guard, bounces, seed, threads and progress (vertices done, not photons). Does not depend on threads. The
// variance is that of independent directions: evenly spread ones come nearer.
// Throws Error where nothing shines and as default_lattice() does, ParameterError for direct light and for groups,
// which only photons keep.
IrradianceGrid bake_grid_by_probes(const LitScene& lit, const GridBakeParams& params, int rays = default_probe_rays);

}  // namespace ivory
