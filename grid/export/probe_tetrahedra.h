// Light probes at the points of a box-shaped grid, joined to tetrahedra: what engines interpolate in that know no
// grids. Delaunay's would be ambiguous (all eight corners of a cell lie on one sphere) and fails in some engines, so
// each cell is split into six, all along the diagonal from its lowest to its highest corner (Kuhn's), which fit
// together across cells. A kd-tree over the cells, then the three planes between the six, finds the one that a point
// lies in.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "grid/base/types.h"
#include "grid/export/probe_volume.h"

namespace ivory {

// A plane and where to go from there: over where normal . p > distance. A child of 0 and more is a node with a higher
// number than its parent's, -(t + 1) is tetrahedron t.
struct BspNode {
  V3f normal{0, 0, 0};  // unit, world
  float distance = 0;   // metres
  std::int32_t over = 0;
  std::int32_t under = 0;
};

struct ProbeTetrahedra {
  std::vector<V3f> points;                              // x fastest
  std::vector<std::array<std::int32_t, 4>> tetrahedra;  // points of each
  std::vector<BspNode> nodes;                           // the root first
};

// Points at origin + i x + j y + k z for each i of at[0], j of at[1], k of at[2], which grow and hold two or more;
// x, y, z are orthogonal.
ProbeTetrahedra probe_tetrahedra(const std::array<std::vector<float>, 3>& at, const V3f& origin,
                                 const std::array<V3f, 3>& axes);

// The probes of a volume as such points, relative to its anchor, with those of its outermost layers once more half a
// cell farther out, where its cells end: what clamped look-ups read there. `sh` are theirs; the volume has nine
// coefficients.
struct VolumeTetrahedra {
  ProbeTetrahedra probes;
  std::vector<ProbeSh9> sh;  // [point]
};
VolumeTetrahedra volume_tetrahedra(const ProbeVolume& volume);

// As Godot 4 reads them (LightStorage::lightmap_tap_sh_light()): the coefficients of the tetrahedron that holds p, by
// barycentric coordinates, each clamped to 0 .. 1.
ProbeSh9 tap(const VolumeTetrahedra& volume, const V3f& p);

}  // namespace ivory
