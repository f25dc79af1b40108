#include "grid/export/probe_volume.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/env/sh9.h"
#include "grid/export/fill.h"
#include "grid/export/sphere_rule.h"
#include "grid/field/lookup.h"

namespace ivory {

const V3f& side_normal(std::size_t side) {
  static const std::array<V3f, 6> normals{V3f(1, 0, 0),  V3f(-1, 0, 0), V3f(0, 1, 0),
                                          V3f(0, -1, 0), V3f(0, 0, 1),  V3f(0, 0, -1)};
  return normals[side];
}

std::size_t ProbeVolume::count(ProbeState state) const {
  return std::size_t(std::count(states.begin(), states.end(), state));
}

V3d ProbeVolume::center_m() const { return to_world(frame.to_world(V3f(frame.size - V3i(1, 1, 1)) * 0.5F), anchor_m); }

LookupParams export_lookup(const IrradianceGrid& grid) {
  LookupParams params;
  params.guard = grid.guard.empty() ? Guard::off : Guard::planes;
  params.nudge_voxels = 0;
  return params;
}

Rgb irradiance(const ProbeSh9& sh, const V3f& n) {
  const std::array<double, 9> polynomials = sh9_polynomials(V3d(n));
  V3d e(0, 0, 0);
  for (std::size_t i = 0; i < 9; ++i) e += V3d(sh[i]) * (sh9_cosine[i] * sh9_factor[i] * polynomials[i]);
  return {std::max(float(e.x), 0.0F), std::max(float(e.y), 0.0F), std::max(float(e.z), 0.0F)};
}

namespace {

bool is_axis_aligned(const GridFrame& frame) {
  constexpr float rounding = 1e-6F;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k)
      if (std::abs(frame.local_to_world[i][k] - (i == k ? 1.0F : 0.0F)) > rounding) return false;
  }
  return true;
}

// Probes along the world's axes in the box around all cells, no farther apart than `spacing`.
GridFrame world_frame(const GridFrame& grid, const V3f& spacing) {
  Box3f box;
  for (int corner = 0; corner < 8; ++corner) {
    V3f index;
    for (int axis = 0; axis < 3; ++axis)
      index[axis] = (corner >> axis & 1) != 0 ? float(grid.size[axis]) - 0.5F : -0.5F;
    box.extendBy(grid.to_world(index));
  }
  const V3f extent = box.max - box.min;
  GridFrame frame;
  double probes = 1;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double rounding = 1e-4;  // of the extent in voxels
    const double count = std::max(2.0, std::ceil(double(extent[axis]) / double(spacing[axis]) - rounding));
    probes *= count;
    if (probes > most_probes) {
      throw ParameterError("voxel_size", "the volume would have more than " + std::to_string(int(most_probes)) +
                                             " probes; ask for a larger one");
    }
    frame.size[axis] = int(count);
    frame.spacing_m[axis] = extent[axis] / float(count);
    frame.origin_m[axis] = box.min[axis] + 0.5F * frame.spacing_m[axis];
  }
  return frame;
}

// What the grid knows at a place: its moments there.
ProbeSh9 project(const IrradianceGrid& grid, const Footprint& footprint) {
  const auto by_rule = [&](const auto& e_of) {
    std::array<V3d, 9> sum;
    sum.fill(V3d(0, 0, 0));
    for (const SphereNode& node : sphere_rule()) {
      const V3d e = e_of(node.direction);
      const std::array<double, 9> polynomials = sh9_polynomials(node.direction);
      for (std::size_t i = 0; i < 9; ++i) sum[i] += e * (node.weight * polynomials[i]);
    }
    ProbeSh9 sh;
    for (std::size_t i = 0; i < 9; ++i) sh[i] = V3f(sum[i] * (sh9_factor[i] / sh9_cosine[i]));
    return sh;
  };
  if (grid.basis != Basis::sh9 && grid.basis != Basis::sh4) {
    return by_rule([&](const V3d& n) { return V3d(irradiance(grid, footprint, V3f(n), Reconstruction::optimal)); });
  }
  // The moments are the coefficients, along the grid's own axes.
  Sh9 local;
  for (int entry = 0; entry < footprint.count; ++entry) {
    const float* moments = grid.at(footprint.vertex[std::size_t(entry)]);
    for (int i = 0; i < function_count(grid.basis); ++i) {
      local.coefficients[std::size_t(i)] +=
          V3d(moments[3 * i], moments[3 * i + 1], moments[3 * i + 2]) * double(footprint.weight[std::size_t(entry)]);
    }
  }
  if (is_axis_aligned(grid.frame)) {
    ProbeSh9 sh;
    for (std::size_t i = 0; i < 9; ++i) sh[i] = V3f(local.coefficients[i]);
    return sh;
  }
  return by_rule(
      [&](const V3d& n) { return irradiance_polynomial(local, V3d(grid.frame.direction_to_local(V3f(n)))); });
}

}  // namespace

ProbeVolume make_probe_volume(const IrradianceGrid& grid, const ProbeVolumeParams& params) {
  ProbeVolume volume;
  volume.anchor_m = grid.anchor_m;
  volume.resampled = params.voxel_size_m || grid.levels() > 1 || (!params.can_rotate && !is_axis_aligned(grid.frame));
  if (volume.resampled) {
    const V3f finest = grid.finest_frame().spacing_m;
    const float least = std::min({finest.x, finest.y, finest.z});
    const V3f own = is_axis_aligned(grid.frame) ? finest : V3f(least, least, least);
    volume.frame = world_frame(grid.frame, params.voxel_size_m ? V3f(1, 1, 1) * *params.voxel_size_m : own);
  } else {
    volume.frame = grid.frame;
  }
  const std::size_t probes = volume.frame.vertex_count();
  volume.sides.resize(probes);
  volume.trust.assign(probes, 0);
  volume.states.assign(probes, ProbeState::dark);
  if (params.with_sh) volume.sh.resize(probes);
  const LookupParams lookup = export_lookup(grid);
  tbb::parallel_for(std::size_t(0), probes, [&](std::size_t i) {
    Footprint footprint;
    float trust = 1;
    if (volume.resampled) {
      const V3f p = volume.frame.to_world(V3f(volume.frame.vertex_coordinates(i)));
      if (grid.frame.covers(p)) footprint = lookup_footprint(grid, p, V3f(0, 0, 0), lookup);
    } else if (grid.visible_fraction[i] > 0) {
      footprint.count = 1;
      footprint.vertex[0] = std::uint32_t(i);
      footprint.weight[0] = 1;
      trust = vertex_trust(grid.visible_fraction[i]);
    }
    SixSides& sides = volume.sides[i];
    float light = 0;
    for (std::size_t side = 0; side < 6; ++side) {
      sides[side] =
          footprint.count > 0 ? irradiance(grid, footprint, side_normal(side), Reconstruction::optimal) : Rgb(0, 0, 0);
      light += max_component(sides[side]);
    }
    if (params.with_sh) {
      volume.sh[i].fill(V3f(0, 0, 0));
      if (light > 0) volume.sh[i] = project(grid, footprint);
    }
    if (!(light > 0)) return;
    volume.states[i] = ProbeState::measured;
    volume.trust[i] = trust;
  });
  fill_unknown(volume, volume.resampled ? std::span<const GuardRecord>() : std::span<const GuardRecord>(grid.guard));
  return volume;
}

}  // namespace ivory
