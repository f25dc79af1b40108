// Random numbers that depend on nothing but (seed, index): for grid/, which knows no tracer, and for what is measured
// of its assets. Own code, as the standard's engines cannot be entered at an index and its distributions give other
// numbers from library to library.
#pragma once

#include <cmath>
#include <cstdint>

#include "grid/base/types.h"

namespace ivory {

// Uniform in [0, 1): SplitMix64 (Steele, Lea & Flood 2014), counted.
inline double counted_uniform(std::uint64_t seed, std::uint64_t index) {
  std::uint64_t z = seed + (index + 1) * 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return double((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
}

// Unit vectors, uniform over the sphere, of u and v uniform in [0, 1).
inline V3d sphere_direction(double u, double v) {
  const double z = 1 - 2 * u;
  const double s = std::sqrt(1 - z * z);
  const double phi = 2 * 3.14159265358979323846 * v;
  return {s * std::cos(phi), z, s * std::sin(phi)};
}

}  // namespace ivory
