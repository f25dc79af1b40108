#include "grid/export/reader.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "grid/base/counted_random.h"
#include "grid/env/sh9.h"
#include "grid/export/survey/plane_points.h"
#include "grid/export/survey/thin_walls.h"
#include "grid/field/guard.h"
#include "grid/field/lookup.h"

namespace ivory {

Footprint probe_footprint(const ProbeVolume& volume, const V3f& p) {
  return make_footprint(volume.frame, p, Interpolation::trilinear);
}

ProbeReader sh9_reader(const ProbeVolume& volume, float offset) {
  return [&volume, offset](const V3f& p, const V3f& n) {
    const Footprint footprint = probe_footprint(volume, p + n * volume.frame.spacing_m * offset);
    ProbeSh9 sh;
    sh.fill(V3f(0, 0, 0));
    for (std::size_t i = 0; i < std::size_t(footprint.count); ++i)
      for (std::size_t k = 0; k < 9; ++k) sh[k] += volume.sh[footprint.vertex[i]][k] * footprint.weight[i];
    return irradiance(sh, n);
  };
}

ProbeReader sides_reader(const ProbeVolume& volume) {
  return [&volume](const V3f& p, const V3f& n) {
    const Footprint footprint = probe_footprint(volume, p);
    Rgb e(0, 0, 0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float c = n[unsigned(axis)];
      const std::size_t side = 2 * axis + (c < 0 ? 1 : 0);
      for (std::size_t i = 0; i < std::size_t(footprint.count); ++i)
        e += volume.sides[footprint.vertex[i]][side] * (footprint.weight[i] * c * c);
    }
    return e;
  };
}

namespace {

// Are all probes around p measured, and in one room?
bool in_the_open(const IrradianceGrid& grid, const ProbeVolume& volume, const V3f& p) {
  const V3f index = volume.frame.to_index(p);
  for (int axis = 0; axis < 3; ++axis)
    if (index[axis] < 0 || index[axis] > float(volume.frame.size[axis] - 1)) return false;
  const Footprint footprint = probe_footprint(volume, p);
  for (std::size_t i = 0; i < std::size_t(footprint.count); ++i) {
    const std::size_t probe = footprint.vertex[i];
    if (volume.states[probe] != ProbeState::measured || volume.trust[probe] < 1) return false;
    if (!has_planes(grid, volume)) continue;
    if (hidden_by(grid.guard[probe], index - V3f(volume.frame.vertex_coordinates(probe))) > 0) return false;
    for (std::size_t k = 0; k < i; ++k)
      if (!see_each_other(grid, probe, footprint.vertex[k])) return false;
  }
  return true;
}

class Sum {
 public:
  void add(const Rgb& read, const Rgb& truth) {
    squares_ += double((read - truth).length2());
    sum_ += double(truth.x + truth.y + truth.z);
    ++count_;
  }
  double relative_rms() const { return sum_ > 0 ? std::sqrt(squares_ * 3 * count_) / sum_ : 0; }
  int count() const { return count_; }

 private:
  double squares_ = 0;
  double sum_ = 0;
  int count_ = 0;
};

constexpr std::uint64_t numbers_a_try = 8;
constexpr std::uint64_t tries_a_point = 200;

Sum measure_in_the_open(const IrradianceGrid& grid, const ProbeVolume& volume, const ProbeReader& reader, float offset,
                        int points, std::uint64_t seed) {
  const LookupParams lookup = export_lookup(grid);
  Sum sum;
  for (std::uint64_t i = 0; i < std::uint64_t(points) * tries_a_point && sum.count() < points; ++i) {
    const auto uniform = [&](std::uint64_t k) { return counted_uniform(seed, numbers_a_try * i + k); };
    V3f index;
    for (unsigned axis = 0; axis < 3; ++axis) index[axis] = float(uniform(axis) * volume.frame.size[axis] - 0.5);
    const V3f p = volume.frame.to_world(index);
    const V3f n(sphere_direction(uniform(3), uniform(4)));
    const V3f moved = p + n * volume.frame.spacing_m * offset;
    if (!grid.frame.covers(p) || !in_the_open(grid, volume, p) || !in_the_open(grid, volume, moved)) continue;
    const Footprint footprint = lookup_footprint(grid, p, V3f(0, 0, 0), lookup);
    const Rgb truth = irradiance(grid, footprint, n, Reconstruction::optimal);
    if (footprint.count > 0 && !is_black(truth)) sum.add(reader(p, n), truth);
  }
  return sum;
}

Sum measure_on_surfaces(const IrradianceGrid& grid, const ProbeReader& reader, int points, std::uint64_t seed) {
  Sum sum;
  if (grid.guard.empty()) return sum;
  LookupParams lookup = export_lookup(grid);
  lookup.nudge_voxels = LookupParams().nudge_voxels;
  for (std::uint64_t i = 0; i < std::uint64_t(points) * tries_a_point && sum.count() < points; ++i) {
    const std::optional<SurfacePoint> at = plane_point(grid, seed, i);
    if (!at) continue;
    const auto& [p, n] = *at;
    const Footprint footprint = lookup_footprint(grid, p, n, lookup);
    const Rgb truth = irradiance(grid, footprint, n, Reconstruction::optimal);
    if (footprint.count > 0 && !is_black(truth)) sum.add(reader(p, n), truth);
  }
  return sum;
}

}  // namespace

ReaderLoss measure_reader(const IrradianceGrid& grid, const ProbeVolume& volume, const ProbeReader& reader,
                          float offset, int points, std::uint64_t seed) {
  const Sum open = measure_in_the_open(grid, volume, reader, offset, points, seed);
  const Sum surfaces = measure_on_surfaces(grid, reader, points, seed + 1);
  return {open.relative_rms(), surfaces.relative_rms(), open.count(), surfaces.count()};
}

}  // namespace ivory
