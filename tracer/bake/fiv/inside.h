// Samples of an FIV table that no receiver reads for itself, because they stand inside the mesh.
#pragma once

#include <span>
#include <vector>

#include "grid/fiv/table.h"
#include "tracer/core/intersector.h"

namespace ivory {

// Which of the positions stand inside: rays from there mostly meet the inner sides of the mesh. Only positions
// with a share of hidden directions of at least half are looked at (`hidden`, one share a position). Meshes may have
// holes, and may be turned inside out as a whole: the sign of their volume tells.
std::vector<char> find_inside(const Intersector& object, const std::vector<V3f>& positions,
                              std::span<const double> hidden);

// Gives samples inside the mean of their neighbours outside, layer by layer from the surface inwards.
void fill_inside(FivTable& table, std::vector<char> inside);

}  // namespace ivory
