// What a bake needs of memory, and how many threads that lets take part.
#pragma once

#include "tracer/bake/field/grid_params.h"
#include "tracer/core/lit_scene.h"

namespace ivory {

// What baking that grid takes on so many threads; less where no light is so much weaker than another that its photons
// need sums of a finer unit.
double grid_memory_bytes(const Lattice& lattice, const GridBakeParams& params, int threads);
// params.max_memory_bytes, or what stands for it.
double memory_limit_bytes(const GridBakeParams& params);

// Throws Error where that grid cannot be baked within params.max_memory_bytes even on one thread: affordable_threads()
// before there is a LitScene.
void check_grid_memory(const Scene& scene, const Lattice& lattice, const GridBakeParams& params);

// How many of params.threads (0: all) can bake that grid within params.max_memory_bytes: each needs sums of its own,
// where they are small (DepositBuffers). At least 1; throws Error where memory would not suffice for one.
int affordable_threads(const LitScene& lit, const Lattice& lattice, const GridBakeParams& params);

}  // namespace ivory
