// From pilots to the plan of a bake: how fine, how many photons, what limits it.
#pragma once

#include <string>

#include "tracer/bake/field/contract/state.h"

namespace ivory {

// Finds the points, bakes pilots and chooses. Where light reaches too little to plan by (state.points.mean_e_lux is 0)
// it is the bake that would be made without an error asked for, and nothing is chosen.
GridPlan make_plan(ContractState& state);

// Chooses anew by state.pilots: sets state.model and state.chosen.
void choose(ContractState& state);

// Is what was chosen, on top of what was done, within what the first plan bears? Sets state.too_dear where it is not.
bool can_afford(ContractState& state);

// What keeps a bake from its target.
std::string what_limits(const ContractState& state);

}  // namespace ivory
