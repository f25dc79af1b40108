// The eight vertices around each of eight points, as arrays by [corner][point]: what look-ups of many points are made
// of.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "grid/field/irradiance_grid.h"

namespace ivory {

inline constexpr std::size_t points_at_once = 8;
template <typename T>
struct alignas(32) Eight : std::array<T, points_at_once> {};
using EightFloats = Eight<float>;

// Points to look up, as LookupPoint has them. Fewer than eight are filled up with the last one.
struct EightPoints {
  std::array<EightFloats, 3> p;
  std::array<EightFloats, 3> ng;
  EightFloats most_m;
  float nudge_voxels = 0;  // of all
};
EightPoints make_points(std::span<const LookupPoint* const> points);

// Corner c stands at base + (c & 1, c >> 1 & 1, c >> 2); entry c of a trilinear Footprint is the c-th that is stored.
struct Corners {
  int level = 0;
  std::array<EightFloats, 3> index;            // index coordinates of the point itself, off the surface
  std::array<EightFloats, 3> base;             // whole numbers
  std::array<Eight<std::uint32_t>, 8> vertex;  // 0 where it is not stored
  std::array<EightFloats, 8> weight;           // 0 where it is not stored
  std::array<EightFloats, 8> fraction;         // visible_fraction, 0 where it is not stored
  Eight<std::uint32_t> stored;                 // [point] bit c: corner c is stored; 0 where too little weight is
  EightFloats kept;                            // [point] as restrict_footprint() answers it
};

// As make_footprint() of the trilinear ones, before any guard; `kept` is 1.
Corners make_corners(const IrradianceGrid& grid, int level, const EightPoints& points);

// As restrict_footprint() with bit c of visible[point] for corner c.
void restrict_corners(const Eight<std::uint32_t>& visible, Corners& corners);

// The footprint of one of the points.
Footprint footprint_of(const Corners& corners, std::size_t point);

// As read_near() of lookup.h for each of the points: the stored planes say what the vertices see, and where those do
// not see the surface either, the point is read closer to it. The grid has planes.
Corners read_near(const IrradianceGrid& grid, int level, const EightPoints& points);

}  // namespace ivory
