// From a scene to the integer sums of an irradiance-vector grid.
#pragma once

#include "grid/field/accumulator.h"
#include "tracer/bake/field/bake_memory.h"
#include "tracer/bake/field/grid_params.h"
#include "tracer/bake/field/placement.h"
#include "tracer/core/lit_scene.h"

namespace ivory {

// Traces the photons and returns what they left, on affordable_threads(); the sums do not depend on how many. Throws
// Error where nothing shines, where memory would not suffice, and as default_lattice() does.
GridAccumulator bake_grid_sums(const LitScene& lit, const GridBakeParams& params);

}  // namespace ivory
