#include "grid/export/reader.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "grid/base/counted_random.h"
#include "grid/env/sh9.h"
#include "grid/field/guard.h"
#include "grid/field/lookup.h"
#include "grid/field/yield.h"

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

// The records of the volume's probes, where they are the grid's vertices.
bool has_planes(const IrradianceGrid& grid, const ProbeVolume& volume) {
  return !volume.resampled && !grid.guard.empty();
}

bool see_each_other(const IrradianceGrid& grid, const GridFrame& frame, std::size_t a, std::size_t b) {
  const V3f step(frame.vertex_coordinates(b) - frame.vertex_coordinates(a));
  return hidden_by(grid.guard[a], step) <= 0 && hidden_by(grid.guard[b], -step) <= 0;
}

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
      if (!see_each_other(grid, volume.frame, probe, footprint.vertex[k])) return false;
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
    const auto uniform = [&](std::uint64_t k) { return counted_uniform(seed, numbers_a_try * i + k); };
    const auto vertex = std::uint32_t(uniform(0) * double(grid.vertex_count()));
    if (!is_lit(grid, vertex)) continue;
    const auto plane = unpack(grid.guard[vertex].words[std::size_t(uniform(1) * guard_planes)]);
    if (!plane || plane->distance < 0 || plane->distance > 1) continue;
    V3f u(float(2 * uniform(2) - 1), float(2 * uniform(3) - 1), float(2 * uniform(4) - 1));
    u += plane->normal * (plane->distance - plane->normal.dot(u));
    constexpr float rounding = 1e-3F;  // it lies in that plane, and before the others
    if (std::max({std::abs(u.x), std::abs(u.y), std::abs(u.z)}) > 1 || hidden_by(grid.guard[vertex], u) > rounding)
      continue;
    const VertexPlace place = grid.place_of(vertex);
    const GridFrame& frame = grid.frame_of(place.level);
    const V3f p = frame.to_world(V3f(place.at) + u);
    // A plane of index coordinates q: its normal in metres goes with 1 / spacing.
    const V3f n = frame.direction_to_world(-plane->normal / frame.spacing_m).normalized();
    if (!grid.frame.covers(p)) continue;
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

std::size_t thin_walls(const IrradianceGrid& grid, const ProbeVolume& volume) {
  if (!has_planes(grid, volume)) return 0;
  const GridFrame& frame = volume.frame;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < frame.vertex_count(); ++i) {
    if (volume.states[i] != ProbeState::measured) continue;
    const V3i at = frame.vertex_coordinates(i);
    for (int axis = 0; axis < 3; ++axis) {
      V3i next = at;
      next[axis] += 1;
      if (next[axis] >= frame.size[axis]) continue;
      const std::size_t other = frame.vertex_index(next.x, next.y, next.z);
      if (volume.states[other] == ProbeState::measured && !see_each_other(grid, frame, i, other)) ++pairs;
    }
  }
  return pairs;
}

}  // namespace ivory
