// The occluder as FIV baking sees it.
#pragma once

#include <optional>
#include <vector>

#include "grid/fiv/light.h"
#include "tracer/core/scene.h"

namespace ivory {

// Instances are moved so that the bounding sphere is the unit sphere about the origin. Lights are left out, spherical
// lights with their meshes.
struct FivOccluder {
  Scene scene;
  V3f center_m;           // of the bounding sphere, in the scene it was made from
  V3d anchor_m{0, 0, 0};  // of that scene
  float radius_m = 1;
  FivShape shape{};
};

// Throws Error where the scene has no triangles or no extent.
FivOccluder make_fiv_occluder(const Scene& scene);

// Where the occluder that `table` was baked from stands, as the part of `scene` that `is_part` (one an instance)
// marks: surface area and centroid give size and place, second moments and reaches tell whether it is the same mesh,
// turned about +Y by turn_rad (counter-clockwise seen from above), or by a turn only that leaves it as it was. Empty
// where it is not.
std::optional<FivPlacement> find_placement(const FivTable& table, const Scene& scene, const std::vector<bool>& is_part,
                                           double turn_rad = 0);

// The same by whatever turn about +Y it may have: none, the one of its first instance's transform, or one that its
// second moments tell.
struct TurnedPlacement {
  FivPlacement at;
  double turn_rad = 0;
};
std::optional<TurnedPlacement> find_turned_placement(const FivTable& table, const Scene& scene,
                                                     const std::vector<bool>& is_part);

}  // namespace ivory
