// Fits the compact leak guard to a scene.
#pragma once

#include <vector>

#include "grid/field/guard.h"
#include "tracer/core/intersector.h"

namespace ivory {

struct GuardFitParams {
  int samples_per_axis = 8;  // stratified points over the support, two voxels wide
  float clip_penalty = 8;    // one visible point clipped weighs as much as this many hidden points let through
  // The same at vertices that no light reaches, for what the planes that clip next to nothing leave over.
  float clip_penalty_dark = 0.25F;
};

// For each vertex with visible_fraction > 0, up to four planes that part what it sees from what it does
// not, within one voxel along each axis. `lit` (tracer/bake/field/lit_vertices.h) tells vertices that hold light from
// those that hold none: the latter, outside a room's corners above all, had better claim too little than too much.
std::vector<GuardRecord> fit_guard(const Intersector& intersector, const Lattice& lattice,
                                   const std::vector<float>& visible_fraction, const std::vector<bool>& lit,
                                   const GuardFitParams& params = {});

}  // namespace ivory
