// FIV tables and the objects that they were baked from: which object is an occluder, and where it stands now.
#pragma once

#include <optional>
#include <vector>

#include "runtime/assets/fiv.h"
#include "tools/view/session/assets.h"
#include "tools/view/world/world.h"

namespace ivory {

struct ViewOccluders {
  std::optional<GpuFivTables> gpu;  // empty without tables
  std::vector<int> of_object;       // for each of the world's objects: index of its occluder, or -1
  std::vector<GpuFivOccluder> own;  // where each stands before its object is moved
  std::vector<std::size_t> object_of;
};

// All tables, and for each object that one of them was baked from (the same mesh, not turned) an occluder. Throws
// Error where OpenGL has no room for the tables, or for so many occluders.
ViewOccluders find_occluders(const ViewAssets& assets, const ViewWorld& world);

// To be called when an object has been taken out of the world. The tables stay on the GPU: nothing can fail.
void remove_occluder(ViewOccluders& occluders, std::size_t object);

// To be called when objects have moved.
void place_occluders(ViewOccluders& occluders, const ViewWorld& world);

}  // namespace ivory
