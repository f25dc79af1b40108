// How look-ups of many points are parted: blocks of footprints, and in a block eight points of a level at a time. For
// those who bring a guard of their own: look_up() and tracer/render/guard_rays.cpp.
#pragma once

#include <functional>

#include "grid/field/batch/corners.h"
#include "grid/field/batch/lookup.h"

namespace ivory {

inline constexpr std::size_t points_a_block = 64;

// Footprints of at most points_a_block points, equal to those of a look-up one by one.
using ReadBlock = std::function<void(std::span<const V3f> p, std::span<const V3f> ng, std::span<Footprint> footprints)>;

std::vector<Rgb> read_irradiance(const IrradianceGrid& grid, const LookupSpans& at, std::span<const V3f> n,
                                 Reconstruction reconstruction, const ReadBlock& read);
std::vector<GridReading> read_readings(const IrradianceGrid& grid, const LookupSpans& at, std::span<const V3f> n,
                                       Reconstruction reconstruction, float unmet_lux, const ReadBlock& read);

// Trilinear footprints of a block in all levels by their shares, where read_level answers the corners, restricted to
// what sees the points. reread(i) answers the footprint of point i one by one: it is asked where less than least_kept
// of the weight is left in a level, and others have to help.
using ReadLevel = std::function<Corners(int level, const EightPoints& points)>;
using Reread = std::function<Footprint(std::size_t point)>;
void read_levels(const IrradianceGrid& grid, std::span<const LookupPoint> at, float least_kept,
                 const ReadLevel& read_level, const Reread& reread, std::span<Footprint> footprints);

// E(n) in lux of as many normals as footprints, at most points_a_block: as irradiance() one by one.
void irradiance(const IrradianceGrid& grid, std::span<const Footprint> footprints, std::span<const V3f> n,
                Reconstruction reconstruction, std::span<Rgb> e);

}  // namespace ivory
