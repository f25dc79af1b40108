// Where a grid lies in its scene, its vertices stand, and its photons are sent.
#pragma once

#include <optional>

#include "tracer/bake/field/grid_params.h"
#include "tracer/core/lit_scene.h"

namespace ivory {

// Vertices along the longest side, where neither resolution nor voxel size is given.
inline constexpr int default_long_side = 32;

// Where the grid lies: it tiles `bounds`, or those of the scene along the grid's axes, exactly by `resolution` or,
// about their centre, by cubic voxels. Flat sides get a twentieth of the longest. A turn by rotate_y_deg takes world +Z
// towards +X. Throws Error for a scene without extent, and ParameterError for a resolution or voxel size that is below
// 2 vertices an axis, not finite, or too fine to number the vertices. With several levels it is the finest one's frame,
// its sides rounded up to multiples of 2^levels vertices, mostly at the far ends.
GridFrame default_frame(const Scene& scene, const GridBakeParams& params);

// params.frame, or default_frame(), as the finest of params.levels levels: make_scene_lattice(), finest in
// params.dynamic_regions too. Throws as they do, and Error where its tables do not fit into params.max_memory_bytes.
Lattice default_lattice(const Scene& scene, const GridBakeParams& params);

// The sphere around the grid's cells, which photons are sent to; none where they are to be sent evenly.
std::optional<EmissionTarget> emission_target(const GridFrame& frame, const GridBakeParams& params);

// Photons of a bake that says nothing of them: 256 a vertex, at least a million.
std::uint64_t default_photons(std::size_t vertices);

}  // namespace ivory
