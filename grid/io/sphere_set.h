// Sphere sets as JSON: {"ivory_asset": "spheres", "format_version": 1, ..., "spheres": [[x, y, z, radius], ...]},
// metres.
#pragma once

#include <string>

#include "grid/lobes/sphere_set.h"

namespace ivory {

// Sets larger than this are refused: each sphere is met by each shaded point.
inline constexpr std::size_t max_spheres = 1'000'000;

// Whole or not at all; throws Error where the file exists and not `force`, or cannot be written.
void write_spheres(const std::string& path, const SphereSet& set, bool force);

// Throws Error for files that are no sphere set, hold none, or hold numbers that make no sphere.
SphereSet read_spheres(const std::string& path);

}  // namespace ivory
