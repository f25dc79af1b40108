// A grid of irradiance on its way to engines that keep probes in box-shaped volumes and read them without a guard:
// where the probes stand, what E is there, and which of them knew nothing and were filled.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "grid/field/irradiance_grid.h"

namespace ivory {

// E in lux at the normals +x, -x, +y, -y, +z, -z of the world.
using SixSides = std::array<Rgb, 6>;
const V3f& side_normal(std::size_t side);

// Radiance coefficients of the world's axes in ivory's order (grid/env/sh9.h), RGB, nits sr^(1/2).
using ProbeSh9 = std::array<V3f, 9>;

enum class ProbeState : std::uint8_t {
  measured,  // the grid knows the light there
  filled,    // it does not, but that of neighbours: fill.h
  dark,      // neither
};

struct ProbeVolume {
  GridFrame frame;                 // a probe at each vertex; relative to the anchor
  V3d anchor_m{0, 0, 0};           // grid/base/anchor.h
  bool resampled = false;          // the probes are not the grid's own vertices
  std::vector<SixSides> sides;     // [probe], x fastest
  std::vector<ProbeSh9> sh;        // [probe]; empty unless asked for
  std::vector<ProbeState> states;  // [probe]
  // [probe] 0 to 1: how much of what is around it the grid's vertex sees (vertex_trust()); 0 where nothing is known.
  std::vector<float> trust;

  std::size_t count(ProbeState state) const;
  // The box of all probes' cells in the world: half a cell beyond the outermost probes.
  V3d center_m() const;
  V3f extent_m() const { return frame.spacing_m * V3f(frame.size); }  // along the frame's axes
};

struct ProbeVolumeParams {
  bool can_rotate = false;  // the reader takes boxes that are turned against the world
  bool with_sh = false;     // nine coefficients a probe as well
  // Metres between probes, of a volume along the world's axes that fills the box around the grid; none: the grid's own
  // vertices, where they stand in one level that the reader can take, else the finest level's spacing.
  std::optional<float> voxel_size_m;
};

inline constexpr double most_probes = 1 << 22;

// Reads the grid with the guard that it has, and fills what it does not know (fill.h). Throws ParameterError
// (voxel_size) where there would be more than most_probes.
ProbeVolume make_probe_volume(const IrradianceGrid& grid, const ProbeVolumeParams& params);

// E(n) of nine coefficients, lux, never negative; n a unit vector.
Rgb irradiance(const ProbeSh9& sh, const V3f& n);

// How a grid is read for an export: by its planes, or without guard where it has none; at the point itself.
LookupParams export_lookup(const IrradianceGrid& grid);

}  // namespace ivory
