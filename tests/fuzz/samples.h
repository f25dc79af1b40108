// Small valid assets of every kind: what the fuzzers begin from.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "grid/cubemap/localized.h"
#include "grid/env/difmap.h"
#include "grid/field/accumulator.h"
#include "grid/field/irradiance_grid.h"
#include "grid/fiv/table.h"
#include "grid/io/cubemap.h"
#include "grid/io/difmap.h"
#include "grid/io/fiv.h"
#include "grid/io/lobes.h"
#include "grid/lobes/table.h"

namespace ivory::fuzz {

inline FivTable sample_fiv(int hemispheres) {
  FivTable table;
  table.size = {3, 2, 2};
  table.hemispheres = hemispheres;
  table.radii = {0.5F, 4};
  for (std::size_t i = 0; i < fiv_sample_count(table) * std::size_t(3 * fiv_function_count(hemispheres)); ++i)
    table.values.push_back(std::sin(float(i)));
  for (std::size_t i = 0; i < table.total.size(); ++i) table.total[i] = float(i);
  for (std::size_t i = 0; i < table.shape.size(); ++i) table.shape[i] = 0.1F * float(i);
  return table;
}

inline DifMap sample_difmap() {
  DifMap map;
  map.e.size = 2;
  map.e.texels.assign(24, Rgb(1, 2, 3));
  map.metadata["environment"] = std::string("sky.hdr");
  return map;
}

inline LocalizedCube sample_cubemap() {
  LocalizedCube cube;
  cube.origin_m = {1, 2, 3};
  cube.radiance.size = 2;
  cube.radiance.texels.assign(24, Rgb(1, 2, 3));
  cube.corners.assign(24, TexelCorners{0.5F, 0.5F, 0.5F, 0.5F});
  return cube;
}

// One by one, as write_exr() keeps them.
inline void write_exr_samples(const std::string& folder) {
  write_fiv(folder + "/fiv1.exr", sample_fiv(1), ExrPrecision::float32, true);
  write_fiv(folder + "/fiv6.exr", sample_fiv(6), ExrPrecision::float16, true);
  write_difmap(folder + "/difmap.exr", sample_difmap(), true);
  write_localized_cube(folder + "/cubemap.exr", sample_cubemap(), true);
  write_lobes(folder + "/lobes.exr", make_lobe_table({2, 3}), {{"method", std::string("moments")}}, true);
}
inline constexpr const char* exr_samples[]{"fiv1", "fiv6", "difmap", "cubemap", "lobes"};

inline IrradianceGrid sample_grid(Basis basis) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal(0, 10);
  IrradianceGrid grid;
  grid.basis = basis;
  grid.frame.size = {2, 3, 2};
  grid.frame.spacing_m = {1, 0.5F, 2};
  grid.visible_fraction.assign(12, 0.5F);
  grid.guard.assign(12, GuardRecord{});
  for (int i = 0; i < 12 * grid.stride(); ++i) grid.moments.push_back(normal(random));
  grid.variance.assign(12, Rgb(1, 2, 3));
  grid.metadata = {{"scene_hash", std::string("00ff")}, {"photons", std::int64_t(1000)}, {"albedo", 0.1}};
  return grid;
}

// Half of the light in each of two groups.
inline IrradianceGrid sample_grid_of_groups() {
  IrradianceGrid grid = sample_grid(Basis::sh4);
  for (const char* name : {"sun", "hall"}) {
    GridGroup group;
    group.name = name;
    group.moments = grid.moments;
    for (float& moment : group.moments) moment /= 2;
    group.variance.assign(12, Rgb(0.5F, 1, 1.5F));
    grid.groups.push_back(std::move(group));
  }
  return grid;
}

// Two levels: 4 x 4 x 4 vertices and one brick.
inline IrradianceGrid sample_grid_of_levels() {
  IrradianceGrid grid = sample_grid(Basis::sh4);
  GridFrame frame = grid.frame;
  frame.size = {4, 4, 4};
  static_cast<Lattice&>(grid) = make_lattice(frame, {{V3i(0, 0, 0)}});
  const std::size_t count = grid.vertex_count();
  grid.visible_fraction.assign(count, 0.5F);
  grid.guard.assign(count, GuardRecord{});
  grid.moments.assign(count * std::size_t(grid.stride()), 2.5F);
  grid.variance.assign(count, Rgb(1, 2, 3));
  return grid;
}

inline GridAccumulator sample_sums(Basis basis, Estimator estimator) {
  GridAccumulator sums;
  sums.basis = basis;
  sums.estimator = estimator;
  sums.frame.size = {2, 3, 2};
  sums.visible_fraction.assign(12, 0.5F);
  sums.guard.assign(12, GuardRecord{});
  sums.sums.assign(12 * std::size_t(sum_layout(basis, estimator).stride()), 7);
  sums.quantum = 1.0 / 3;
  sums.quantum_squared = 1e-7;
  sums.photon_begin = 0;
  sums.photon_end = 1000;
  sums.counters = {{"rays", 5}, {"ledger_emitted", 5}};
  sums.metadata = {{"photons", std::int64_t(1000)}, {"method", std::string("photons")}};
  return sums;
}

}  // namespace ivory::fuzz
