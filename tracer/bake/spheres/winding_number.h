// How often a surface winds around a point: 1 inside a closed mesh and 0 outside, and a sensible fraction where the
// mesh has holes (Jacobson, Kavan & Sorkine-Hornung 2013).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "grid/base/types.h"

namespace ivory {

using Triangle3d = std::array<V3d, 3>;

// Sum of signed solid angles over 4 pi, far groups of triangles as dipoles (Barill et al. 2018). Thread-safe.
class WindingNumber {
 public:
  // Keeps a copy, reordered. Triangles without area add nothing.
  explicit WindingNumber(std::vector<Triangle3d> triangles);

  double at(const V3d& p) const;

 private:
  struct Node {
    V3d center{0, 0, 0};  // area-weighted
    V3d dipole{0, 0, 0};  // sum of area times normal
    double radius = 0;    // of all vertices about the centre
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    std::uint32_t child = 0;  // of two, side by side; 0: a leaf
  };
  void build(std::uint32_t node);

  std::vector<Triangle3d> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace ivory
