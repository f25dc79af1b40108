// What a grid rests on: how many photons its vertices were met by, and what is known where none came.
#pragma once

#include <optional>

#include "grid/field/accumulator.h"

namespace ivory {

inline constexpr double few_photons = 8;  // fewer leave an error of more than a third

struct Evidence {
  std::size_t vertices = 0;  // that store light
  std::size_t unmet = 0;     // of these, that no photon came to
  std::size_t few = 0;       // that some came to, fewer than few_photons
  double median = 0;         // photons at those that some came to; 0 where there are none
};

// Photons count by their weights, as (sum of x)^2 / (sum of x^2): one that carries as much as all others together
// leaves four at most.
Evidence evidence(const GridAccumulator& accumulator);

// Where no photon came, E is not known to be 0, but with 95 % confidence to be at most this, lux in each channel: what
// three photons of mean power would have left in a cell (the rule of three: had three been expected, none would have
// come in 5 of 100 bakes). Nothing where the grid does not say how many photons were traced and what they carried.
std::optional<float> unmet_bound_lux(const IrradianceGrid& grid);

}  // namespace ivory
