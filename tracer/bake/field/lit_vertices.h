// Which grid vertices light reaches at all.
#pragma once

#include <vector>

#include "grid/field/irradiance_grid.h"
#include "tracer/render/photons/tracer.h"

namespace ivory {

// Traces the first `photons` photons and marks the vertices into whose visible subcells any of their
// segments goes. Depends on the scene and the tracer's seed alone, so that all parts of a bake agree.
std::vector<bool> lit_vertices(const PhotonTracer& tracer, const Lattice& lattice,
                               const std::vector<std::uint64_t>& cell_masks, std::uint64_t photons);

}  // namespace ivory
