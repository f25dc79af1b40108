// The spacings that a grid to an error may be baked at.
#pragma once

#include <string>
#include <vector>

#include "tracer/bake/field/baker.h"

namespace ivory {

struct GridCandidate {
  GridBakeParams bake;
  Lattice lattice;

  const GridFrame& finest() const { return lattice.finest_frame(); }
};

struct GridCandidates {
  std::vector<GridCandidate> list;  // the coarsest first; at least one
  std::string limited_by;           // what keeps finer ones out

  bool is_single() const { return list.size() == 1; }
};

inline constexpr int coarsest_layers = 8;  // along the longest side, of the coarsest candidate and the first pilot

// Spacings a quarter of an octave apart, from the first pilot's down to what memory holds; the one that is given,
// where one is. `cover` is the box that is asked for. Throws as check_grid_memory() does where the coarsest is too
// much.
GridCandidates make_candidates(const Scene& scene, const GridBakeParams& asked, const GridFrame& cover);

// The box that is asked for, cut into as few cells as may be.
GridFrame covering_frame(const Scene& scene, GridBakeParams params);

double spacing_of(const GridFrame& frame);  // geometric mean of the three axes, metres
double layers_of(const GridFrame& frame);   // vertices along the longest side
double longest_m(const GridFrame& frame);

// Spacings side by side, each twice the one before, as many as leave the coarsest at least 12 vertices along the
// longest side: fine where surfaces are, coarse in the open. Only sums of the track estimator can be kept so.
int levels_for(double layers, Estimator estimator);

}  // namespace ivory
