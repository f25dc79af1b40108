// Integrals of radiance times 1, w and w w over the sphere: all that spherical harmonics to band 2 hold. Each map is
// taken as piecewise constant and integrated texel by texel, in double.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "grid/env/angular_map.h"
#include "grid/env/cube_map.h"

namespace ivory {

// Per colour channel, in nits sr (w has no unit).
struct RadianceMoments {
  V3d total{0, 0, 0};                                                   // integral of L
  std::array<V3d, 3> first{V3d(0, 0, 0), V3d(0, 0, 0), V3d(0, 0, 0)};   // L w_x, L w_y, L w_z
  std::array<V3d, 6> second{V3d(0, 0, 0), V3d(0, 0, 0), V3d(0, 0, 0),   // L w_x w_x, w_y w_y, w_z w_z,
                            V3d(0, 0, 0), V3d(0, 0, 0), V3d(0, 0, 0)};  // L w_x w_y, w_y w_z, w_x w_z

  RadianceMoments& operator+=(const RadianceMoments& other);
};

// The rows row_begin .. row_end - 1 of a map. Sums over disjoint ranges add up to the whole; each range's own sum runs
// in a fixed order.
//
// Lat-long: exact (closed form); one pass at the pace of memory.
RadianceMoments latlong_moments(std::span<const Rgb> texels, int width, int height, int row_begin, int row_end);
// Cube (these rows of all six faces): Gauss rule, relative error below 1e-9.
RadianceMoments cube_moments(const CubeMap& map, int row_begin, int row_end);
// Angular: to the accuracy of angular_nodes().
RadianceMoments angular_moments(const AngularMap& map, int row_begin, int row_end);

// One texel's share: solid angle in sr and the integral of w over it.
struct TexelMoments {
  double solid_angle = 0;
  V3d first{0, 0, 0};
};

// Texels of a lat-long map, closed form.
class LatLongTexels {
 public:
  LatLongTexels(int width, int height);
  TexelMoments operator()(int row, int column) const;

 private:
  std::vector<std::array<double, 3>> rows_;     // integrals of sin, sin^2, sin cos over the row's polar angles
  std::vector<std::array<double, 2>> columns_;  // integrals of cos, sin over the column's azimuths
  double column_width_ = 0;
};

// Texels of a cube map in its face's own axes (right, down, forward), the same for all faces.
TexelMoments cube_texel_moments(int size, int row, int column);
// Of an angular map; zero outside the disc.
TexelMoments angular_texel_moments(int size, int row, int column);

}  // namespace ivory
