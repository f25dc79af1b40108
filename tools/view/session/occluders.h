// FIV tables and the objects that they were baked from: which object is an occluder, and where it stands now.
#pragma once

#include <optional>

#include "runtime/assets/fiv.h"
#include "tools/view/session/assets.h"
#include "tools/view/world/world.h"

namespace ivory {

// All tables on the GPU; empty where there are none. Each object that a table was baked from (the same mesh, not
// turned) becomes an occluder. Throws Error where OpenGL has no room for the tables or there are too many occluders,
// and leaves the objects as they were.
std::optional<GpuFivTables> find_occluders(const ViewAssets& assets, ViewWorld& world);

// To be called when objects have moved or were taken out.
void place_occluders(GpuFivTables& tables, const ViewWorld& world);

// Which of the placed occluders the object is, or -1.
int occluder_index(const ViewWorld& world, std::size_t object);

}  // namespace ivory
