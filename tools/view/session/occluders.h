// FIV tables and the objects that they were baked from: which object is an occluder, and where it stands now.
#pragma once

#include <optional>
#include <string>

#include "runtime/assets/fiv.h"
#include "tools/view/session/assets.h"
#include "tools/view/world/world.h"

namespace ivory {

// All tables on the GPU; empty where there are none. Each object that a table was baked from (the same mesh, turned
// about +Y at most) becomes an occluder. Throws Error for tables whose environments were turned otherwise than one
// another's. Throws Error where OpenGL has no room for the tables or there are too many occluders, and leaves the
// objects as they were.
std::optional<GpuFivTables> find_occluders(const ViewAssets& assets, ViewWorld& world);

// The same occluders' places in a new pose of their objects, whose tables are on the GPU already: what no longer is the
// mesh of its table is none.
void find_occluders_again(const ViewAssets& assets, ViewWorld& world);

// To be called when objects or the environment have moved or were taken out. `environment_turn_deg`: its turn against
// the tables'. Objects that are turned as their tables cannot be (otherwise than about +Y, or at all where there is one
// table alone) hide nothing then.
void place_occluders(GpuFivTables& tables, ViewWorld& world, double environment_turn_deg);

// A line for an object that occludes no longer.
std::string why_it_hides_nothing(const ViewObject& object, double time_s);

// Which of the placed occluders the object is, or -1.
int occluder_index(const ViewWorld& world, std::size_t object);

}  // namespace ivory
