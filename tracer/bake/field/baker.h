// From a scene to the integer sums of an irradiance-vector grid.
#pragma once

#include <optional>

#include "grid/field/accumulator.h"
#include "tracer/bake/field/bake_memory.h"
#include "tracer/bake/field/grid_params.h"
#include "tracer/bake/field/placement.h"
#include "tracer/core/lit_scene.h"

namespace ivory {

// Traces the photons and returns what they left, on affordable_threads(); the sums do not depend on how many.
// `at_hand`, where given, are the sums of the same bake's photons right before params.photon_range, which the result
// takes in (none where only a checkpoint has them). With params.checkpoint the bake goes on from the file that is
// there, to the same sums, and throws BakeStopped where it is asked to stop. Throws Error where nothing shines, where
// memory would not suffice, where a checkpoint is of another bake or damaged, and as default_lattice() does.
GridAccumulator bake_grid_sums(const LitScene& lit, const GridBakeParams& params,
                               std::optional<GridAccumulator> at_hand = std::nullopt);

// What a grid file says of its making, whatever its light was found by.
Metadata grid_facts(const Scene& scene, const GridBakeParams& params, const Lattice& lattice);

}  // namespace ivory
