// Spheres packed into voxels: the optimisation behind fit_spheres().
#pragma once

#include <functional>
#include <vector>

#include "grid/base/types.h"

namespace ivory {

// In units of voxels, the grid's corner at the origin.
struct PackedSphere {
  V3d center;
  double radius = 0;
};

struct Voxels {
  V3i size;
  int padding = 1;                     // voxels around the mesh's box, at least 1
  std::vector<std::int8_t> score;      // what covering the voxel gains; below 0 outside the solid
  std::vector<std::uint16_t> covered;  // by how many spheres

  std::size_t index(int x, int y, int z) const {
    return (std::size_t(z) * std::size_t(size.y) + std::size_t(y)) * std::size_t(size.x) + std::size_t(x);
  }
};

struct SpherePackingParams {
  int count = 64;
  int rounds = 12;                       // of refinement at most; it ends when nothing improves
  bool sheets = false;                   // look for uncovered surface too, not for uncovered depth alone
  std::function<void(double)> progress;  // called now and then with the fraction done
};

// Spheres, at most `count`, whose union holds as much score as can be found. Deterministic. Leaves in voxels.covered by
// how many of them each voxel is covered.
std::vector<PackedSphere> pack_spheres(Voxels& voxels, const SpherePackingParams& params);

}  // namespace ivory
