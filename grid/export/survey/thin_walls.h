// Walls thinner than a cell of a volume of probes: readers without a guard show light from behind them.
#pragma once

#include <vector>

#include "grid/export/reader.h"

namespace ivory {

// Are the volume's probes the grid's own vertices, with planes?
bool has_planes(const IrradianceGrid& grid, const ProbeVolume& volume);
// Of such a volume: do the two vertices see each other by their planes? They are neighbours.
bool see_each_other(const IrradianceGrid& grid, std::size_t a, std::size_t b);

// Pairs of neighbouring probes that are both lit and do not see each other. 0 for a volume without planes.
std::size_t thin_walls(const IrradianceGrid& grid, const ProbeVolume& volume);

// Such pairs side by side, and what the reader shows of the wall between, where its faces cross the line from probe to
// probe: its E there less that of the grid's look-up by planes.
struct ThinWall {
  V3f center;    // relative to the volume's anchor
  int axis = 0;  // of the volume's frame, that it lies across
  std::size_t pairs = 0;
  double area_m2 = 0;        // of the cells' faces between the pairs
  double rms_lux = 0;        // of both faces' differences, mean of channels
  double brightest_lux = 0;  // the largest difference, where the reader shows too much; at least 0
  double darkest_lux = 0;    // and where it shows too little; at most 0
};
// Those with the largest difference first. Empty for a volume without planes.
std::vector<ThinWall> measure_thin_walls(const IrradianceGrid& grid, const ProbeVolume& volume,
                                         const ProbeReader& reader);

}  // namespace ivory
