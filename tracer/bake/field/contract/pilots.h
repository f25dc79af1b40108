// Pilot bakes: what small ones show of the error of larger ones.
#pragma once

#include "tracer/bake/field/contract/state.h"

namespace ivory {

// Bakes a pilot of so many vertices along the longest side (of the given spacing, where one is given and no finer),
// twice where the photons were badly guessed. Adds to state.pilots and state.times; its sums are those at hand.
void add_pilot(ContractState& state, double layers);

// What such a pilot is to take on the cost model's machine; infinite where memory does not hold it.
double pilot_seconds(const ContractState& state, double layers);

// Its lattice.
Lattice pilot_lattice(const ContractState& state, double layers);

}  // namespace ivory
