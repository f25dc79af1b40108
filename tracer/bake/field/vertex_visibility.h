// How much of its own cell each grid vertex sees.
#pragma once

#include <vector>

#include "grid/field/irradiance_grid.h"
#include "tracer/core/intersector.h"

namespace ivory {

// Bit ((z * 4 + y) * 4 + x) of entry v is set where vertex v sees all eight corners of that subcell, a quarter of
// a voxel wide. Photons count for a vertex only there, so that light behind a wall stays out of its mean. What is
// thinner than a subcell and passes between the corners is missed. All ones for an empty scene.
std::vector<std::uint64_t> vertex_cell_masks(const Intersector& intersector, const Lattice& lattice);

// Set bits over 64.
std::vector<float> visible_fractions(const std::vector<std::uint64_t>& masks);

}  // namespace ivory
