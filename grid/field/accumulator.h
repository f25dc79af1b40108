// The exact result of tracing a range of photons: integer sums, which add up to the same bits in
// any order, on any number of threads, machines and sessions.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "grid/field/irradiance_grid.h"

namespace ivory {

enum class Estimator { track, face, face_paper };
std::string_view name(Estimator estimator);
Estimator estimator_from_name(std::string_view name);

// How photons are sorted into sums at a vertex: `slots` groups of `functions` moments, each RGB, and
// per group an RGB second moment. Three layouts:
//   octants      8 slots by the signs of w (bit 0: w.x < 0, bit 1: w.y < 0, bit 2: w.z < 0), functions
//                |w_x|, |w_y|, |w_z|: everything that folds from hemispheres (vectors, vectors9, ambient_cube)
//   hemispheres  6 slots +x, -x, +y, ..., functions w_x, w_y, w_z: the face estimators
//   whole        1 slot, the basis' own functions: sh9, sh4
struct SumLayout {
  int slots = 8;
  int functions = 3;
  int lanes() const { return (functions + 1) * 3; }
  int stride() const { return slots * lanes(); }
};
// Throws UsageError for a face estimator on a basis other than vectors.
SumLayout sum_layout(Basis basis, Estimator estimator);

struct GridSums {
  GridFrame frame;
  Basis basis = Basis::vectors;
  Estimator estimator = Estimator::track;
  // [vertex][slot][function 0, 1, ..., second moment][rgb] in units of the quanta. track sums
  // flux times length, the face estimators sum flux; `quantum` and `quantum_squared` are the size of
  // one unit of a moment and of a second moment (lm m and its square; lm and its square).
  std::vector<std::int64_t> sums;
  double quantum = 0;
  double quantum_squared = 0;
  std::vector<float> visible_fraction;  // as in IrradianceGrid; from the scene, not from photons
  std::vector<GuardRecord> guard;
  std::uint64_t photon_begin = 0;  // half-open range of photon indices traced so far
  std::uint64_t photon_end = 0;
  // Integer totals over the photons traced ("ledger_emitted", "photons_traced", ...), added up by merge().
  std::map<std::string, std::int64_t> counters;
  Metadata metadata;
};

// Adds up parts of one bake. Throws Error where they differ in anything but their photon range, or
// where ranges overlap or leave a gap.
GridSums merge(std::vector<GridSums> parts, const std::vector<std::string>& names);

// Divides by cell volume (track) or face area (face) and photon count, and folds to the stored moments.
IrradianceGrid finish(const GridSums& sums);

}  // namespace ivory
