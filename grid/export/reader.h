// What readers of probe volumes show, and how far that is from the grid: the look-ups of engines, rewritten on what is
// written for them.
#pragma once

#include <cstdint>
#include <functional>

#include "grid/export/probe_volume.h"

namespace ivory {

// E in lux that a reader shows at p (relative to the volume's anchor) for the unit normal n, both in the world.
using ProbeReader = std::function<Rgb(const V3f& p, const V3f& n)>;

// The eight probes around p and their weights, clamped to the outermost ones: what filtering a 3D texture reads.
Footprint probe_footprint(const ProbeVolume& volume, const V3f& p);

// Nine coefficients, filtered, at p + n times `offset` of the spacing along each axis: three.js' LightProbeGrid with an
// offset of a half (lightprobes_pars_fragment.glsl.js), plain volumes of coefficients with none.
ProbeReader sh9_reader(const ProbeVolume& volume, float offset);

// Six sides, filtered, and blended by the squares of n's coordinates: Bevy (irradiance_volume.wesl), and any ambient
// cube after Valve's.
ProbeReader sides_reader(const ProbeVolume& volume);

// How far a reader is from the grid, RMS over points, normals and channels of the difference in E, over the grid's mean
// E there. In the open: random points with random normals, where all probes around the point, and around where the
// reader looks, are measured and see each other. On surfaces: random points of the planes that the grid's guard knows
// within a voxel of lit vertices, with the planes' normals; none where the grid has no guard.
struct ReaderLoss {
  double in_the_open = 0;
  double on_surfaces = 0;
  int points_in_the_open = 0;
  int points_on_surfaces = 0;
};

// At up to `points` points of either kind that the grid knows light at. `offset`: as sh9_reader() has it. The same for
// the same seed.
ReaderLoss measure_reader(const IrradianceGrid& grid, const ProbeVolume& volume, const ProbeReader& reader,
                          float offset, int points, std::uint64_t seed);

}  // namespace ivory
