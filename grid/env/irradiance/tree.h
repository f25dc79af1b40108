// Irradiance of a distant environment for any normal, to a known error, without visiting every texel: a hierarchy of
// the light's moments over the faces of a cube.
#pragma once

#include <array>
#include <vector>

#include "grid/base/types.h"
#include "grid/env/cube_map.h"

namespace ivory {

class IrradianceTree {
 public:
  // Texels of a map of any layout are dropped by their mean directions into the cells of a cube map with `size` cells
  // along an edge, a power of two.
  explicit IrradianceTree(int size);

  // One texel: its radiance, solid angle (sr), integral of w over it, and how far from its mean direction it reaches at
  // most. Not to be called by several threads at once.
  void add(const Rgb& radiance, double solid_angle, const V3d& first, double half_angle_rad);
  // Once, after the last texel: merges cells four at a time up to the faces.
  void finish();

  struct Estimate {
    V3d e{0, 0, 0};      // lux, per channel
    V3d error{0, 0, 0};  // |e - exact| is at most this, for maps constant over each texel
  };
  // E(n), n a unit vector. Cells wholly above or below the horizon count exactly; one that the horizon may cut is
  // opened until what it can be wrong by is below `tolerance` times the light of the whole sphere, or it is a leaf.
  Estimate irradiance(const V3d& n, double tolerance = 1e-6) const;

  // Integral of L over the sphere, nits sr.
  V3d total() const;

 private:
  struct Cell {
    V3d flux{0, 0, 0};                                                    // integral of L
    std::array<V3d, 3> vector{V3d(0, 0, 0), V3d(0, 0, 0), V3d(0, 0, 0)};  // of L w_x, L w_y, L w_z
    V3d axis{0, 0, 1};                                                    // all light lies within `half_angle` of it
    double half_angle = 0;
    double sine = 0;  // of half_angle; 2 beyond a right angle
    double cosine = 1;
  };

  void visit(std::size_t level, int face, int row, int column, const V3d& n, const V3d& allowed, Estimate& sum) const;

  int size_;
  std::vector<std::vector<Cell>> levels_;  // 1, 2, 4 ... size cells along an edge
};

}  // namespace ivory
