// The exact result of tracing a range of photons: integer sums, which add up to the same bits in any order, on any
// number of threads, machines and sessions.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "grid/field/irradiance_grid.h"

namespace ivory {

// How the photons that pass a vertex become its moments.
enum class Estimator {
  track,       // flux times the length of the path inside the vertex's cell
  face,        // flux over |cos| through the faces of the voxels
  face_paper,  // the same without 1/|cos|, as published
};
template <>
inline constexpr auto name_table<Estimator> = make_name_table<Estimator>(
    "estimator", {{Estimator::track, "track"}, {Estimator::face, "face"}, {Estimator::face_paper, "face_paper"}});

// How photons are sorted into sums at a vertex: `slots` groups of `functions` moments, each RGB, and per group an RGB
// second moment. Three layouts:
//   octants      8 slots by the signs of w (bit 0: w.x < 0, bit 1: w.y < 0, bit 2: w.z < 0), functions
//                |w_x|, |w_y|, |w_z|: everything that folds from hemispheres (vectors, vectors9, ambient_cube)
//   hemispheres  6 slots +x, -x, +y, ..., functions w_x, w_y, w_z: the face estimators
//   whole        1 slot, the basis' own functions: sh9, sh4
struct SumLayout {
  int slots = 8;
  int functions = 3;
  int lanes() const { return (functions + 1) * 3; }  // numbers a slot
  int stride() const { return slots * lanes(); }     // numbers a vertex
};
// Throws ParameterError for a face estimator on a basis other than vectors.
SumLayout sum_layout(Basis basis, Estimator estimator);

// What the lights of one group brought, of a bake that keeps groups apart.
struct SumGroup {
  std::string name;
  std::vector<std::int64_t> sums;  // as GridAccumulator::sums
};

struct GridAccumulator : GridVertices {
  Estimator estimator = Estimator::track;
  // [vertex][slot][function 0, 1, ..., second moment][rgb] in units of the quanta. track sums flux times length, the
  // face estimators sum flux.
  std::vector<std::int64_t> sums;
  // Of the coarsest level; each finer level has half and a quarter of them, so that its sums are those of a uniform
  // grid of its spacing.
  double quantum = 0;              // one unit of a moment: lm m; lm for the face estimators
  double quantum_squared = 0;      // one unit of a second moment: (lm m)^2; lm^2
  std::uint64_t photon_begin = 0;  // half-open range of photon indices traced so far
  std::uint64_t photon_end = 0;
  // Integer totals over the photons traced ("ledger_emitted", "photons_traced", ...), added up by merge().
  std::map<std::string, std::int64_t> counters;
  // They add up to `sums`, exactly; empty: groups were not kept apart.
  std::vector<SumGroup> groups;
};

// What keeps two from being parts of one bake, photons aside: the first of its facts that differs, in words; empty
// where nothing does.
std::string difference(const GridAccumulator& a, const GridAccumulator& b);

// Adds up parts of one bake; names[i] is what messages call parts[i]. Throws ParameterError for no parts, and Error
// where they differ in anything but their photon range, where ranges overlap or leave a gap, or where a sum exceeds 64
// bits.
GridAccumulator merge(std::vector<GridAccumulator> parts, const std::vector<std::string>& names);

}  // namespace ivory
