// The compact leak guard: what a vertex sees within one voxel around it, as up to four planes in 16 bytes. Small enough
// to go to the GPU beside the grid; fitted by tracer/bake/field/guard_fit.h.
#pragma once

#include <optional>

#include "grid/field/irradiance_grid.h"

namespace ivory {

// Offsets u from the vertex, in voxels along the grid's own axes, are visible where n.u <= distance.
struct GuardPlane {
  V3f normal;          // unit
  float distance = 0;  // voxels, kept within [-2, 2)
};
inline constexpr int guard_planes = 4;

// One plane in 32 bits: octahedral normal 10 + 10, distance 12. Never below no_guard_plane: such words stand for no
// plane and unpack to nothing. Files hold 0 for it.
inline constexpr std::uint32_t no_guard_plane = 1U << 20U;
std::uint32_t pack(const GuardPlane& plane);
std::optional<GuardPlane> unpack(std::uint32_t word);

// How far, in voxels, the point at offset u (voxels, the grid's own axes) lies beyond the plane that hides it most:
// positive where the vertex does not see it, very negative where no plane is set.
float hidden_by(const GuardRecord& record, const V3f& u);

// A vertex this little behind a surface stands in its plane: rounding has no say about it.
inline constexpr float in_plane_voxels = 0.01F;

// The entries whose vertices, of one level, see the point by their planes from where that level reads it; all of them
// for a grid without guard. Planes are fitted within a voxel of their vertex, and those of the wider, tricubic
// footprint may not know of a wall between: its vertices behind the surface do not count. What the planes let through
// wrongly gives way: yield.h. `near` is the narrower footprint that a wide one is to help out, restricted to what sees
// the point; null: there is none, or nothing of it does.
VisibleEntries visible_by_guard(const IrradianceGrid& grid, const LookupPoint& at, const Footprint& footprint,
                                const Footprint* near = nullptr);

}  // namespace ivory
