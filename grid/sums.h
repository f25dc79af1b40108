// The exact result of tracing a range of photons: integer sums, which add up to the same bits in
// any order, on any number of threads, machines and sessions.
#pragma once

#include <vector>

#include "grid/irradiance_grid.h"

namespace ivory {

enum class Estimator { track, face, face_paper };
std::string_view name(Estimator estimator);
Estimator estimator_from_name(std::string_view name);

// How photons are sorted into sums at a vertex: `slots` groups (octants, hemispheres, or one) of
// `functions` moments, each RGB, plus per group the RGB second moment.
struct SumLayout {
  int slots = 8;
  int functions = 3;
  int stride() const { return slots * (functions + 1) * 3; }
};
SumLayout sum_layout(Basis basis, Estimator estimator);

struct GridSums {
  GridFrame frame;
  Basis basis = Basis::vectors;
  Estimator estimator = Estimator::track;
  std::vector<std::int64_t> sums;       // [vertex][slot][function or second moment][rgb]
  double quantum = 0;                   // lux m^3 (track) or lux m^2 (face) per unit of a moment, times photons
  double quantum_squared = 0;           // the same for second moments
  std::vector<float> visible_fraction;  // as in IrradianceGrid; from the scene, not from photons
  std::vector<GuardRecord> guard;
  std::uint64_t photon_begin = 0;  // half-open range of photon indices traced so far
  std::uint64_t photon_end = 0;
  Metadata metadata;
};

// Adds up parts of one bake. Throws Error where they differ in anything but their photon range, or
// where ranges overlap or leave a gap.
GridSums merge(std::vector<GridSums> parts, const std::vector<std::string>& names);

// Divides by cell volume (track) or face area (face) and photon count, and folds to the stored moments.
IrradianceGrid finish(const GridSums& sums);

}  // namespace ivory
