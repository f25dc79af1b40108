// Grids to compare the GPU's look-ups with the CPU's on.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "grid/base/half.h"
#include "grid/field/compact_vectors.h"
#include "grid/field/lookup.h"
#include "runtime/assets/irradiance_grid.h"
#include "tests/support/runtime_twin.h"

namespace ivory {

// A grid of made-up light: at each vertex a few directions, of 1e-3 to 1e5 lux where `uneven`, else of 3000 to 30,000.
// A tenth of the vertices store nothing, a fifth see little of their cells, a sixth are unlit, and most have planes
// that cut off a part of what lies within a voxel.
inline IrradianceGrid random_grid_on(const Lattice& lattice, Basis basis, bool uneven, std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(0, 1);
  IrradianceGrid grid;
  static_cast<Lattice&>(grid) = lattice;
  grid.basis = basis;
  const std::size_t vertices = grid.vertex_count();
  grid.moments.assign(vertices * std::size_t(grid.stride()), 0);
  grid.visible_fraction.assign(vertices, 0);
  grid.variance.assign(vertices, Rgb(0, 0, 0));
  grid.guard.assign(vertices, {});
  for (std::size_t v = 0; v < vertices; ++v) {
    if (uniform(random) < 0.1F) continue;
    grid.visible_fraction[v] = uniform(random) < 0.2F ? std::ceil(16 * uniform(random)) / 64 : 1;
    const bool lit = uniform(random) < 5.0F / 6;
    const float lux = !lit     ? 0
                      : uneven ? std::pow(10.0F, 8 * uniform(random) - 3)
                               : 3000 * std::pow(10.0F, uniform(random));
    for (int light = 0; light < 4; ++light) {
      const auto f = eval(basis, random_direction(random));
      const Rgb colour(lux * uniform(random), lux * uniform(random), lux * uniform(random));
      float* m = grid.moments.data() + v * std::size_t(grid.stride());
      for (std::size_t k = 0; k < std::size_t(function_count(basis)); ++k) {
        for (std::size_t c = 0; c < 3; ++c) m[3 * k + c] += f[k] * colour[unsigned(c)];
      }
    }
    const int planes = int(uniform(random) * 5);
    for (int i = 0; i < std::min(planes, 4); ++i)
      grid.guard[v].words[std::size_t(i)] = pack({random_direction(random), uniform(random) * 1.2F - 0.2F});
  }
  return grid;
}

inline IrradianceGrid random_grid(const V3i& size, Basis basis, bool rotated, bool uneven, std::uint32_t seed) {
  std::mt19937 random(seed);
  GridFrame frame;
  frame.size = size;
  frame.origin_m = V3f(3, -2, 7);
  frame.spacing_m = V3f(0.5F, 0.7F, 0.4F);
  if (rotated) {
    const V3f x = random_direction(random);
    const V3f y = x.cross(random_direction(random)).normalized();
    const V3f z = x.cross(y);
    frame.local_to_world = M33f(x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z);
  }
  return random_grid_on(frame, basis, uneven, random);
}

// Twelve triples a vertex as the texture holds them: of that form, rounded to half in its unit.
struct StoredGrid {
  GridForm form = GridForm::moments;
  std::vector<float> values;  // [vertex][stride], lux; directions of norms_and_directions are unit vectors

  StoredGrid(const IrradianceGrid& grid, const GpuGrid& gpu) : form(gpu.form), values(grid.moments) {
    const auto stride = std::size_t(grid.stride());
    for (std::size_t v = 0; v < grid.vertex_count(); ++v) {
      float* m = values.data() + v * stride;
      if (form == GridForm::norms_and_directions) {
        const auto compact = compact_from_moments(std::span<const float, 36>(m, 36));
        std::copy(compact.begin(), compact.end(), m);
      }
      const float trust = vertex_trust(grid.visible_fraction[v]);
      for (std::size_t i = 0; i < stride && trust > 0; ++i) {
        const float unit = form == GridForm::norms_and_directions && i >= 18 ? 1 : gpu.scale;
        m[i] = rounded_to_half(m[i] * trust / unit) * unit / trust;
      }
    }
  }
};

// E(n) and how large the numbers are that it is made of.
struct TwinIrradiance {
  Rgb e;
  float largest = 0;  // weighted mean of the vertices' largest moments
  float around = 0;   // the largest of any vertex that a weight off by rounding may bring in, as the texture holds it
};

inline TwinIrradiance irradiance_of(const IrradianceGrid& grid, const StoredGrid& stored, const V3f& nudged,
                                    const Footprint& footprint, const V3f& n, Reconstruction reconstruction) {
  const auto stride = std::size_t(grid.stride());
  std::array<float, 36> sum{};
  TwinIrradiance out;
  for (std::size_t i = 0; i < std::size_t(footprint.count); ++i) {
    const float* m = stored.values.data() + footprint.vertex[i] * stride;
    float largest = 0;
    for (std::size_t k = 0; k < stride; ++k) {
      sum[k] += footprint.weight[i] * m[k];
      largest = std::max(largest, std::abs(m[k]));
    }
    out.largest += footprint.weight[i] * largest;
  }
  const auto look_around = [&](const Footprint& wide) {
    for (std::size_t i = 0; i < std::size_t(wide.count); ++i) {
      const float trust = vertex_trust(grid.visible_fraction[wide.vertex[i]]);
      for (std::size_t k = 0; k < stride; ++k)
        out.around = std::max(out.around, trust * std::abs(stored.values[wide.vertex[i] * stride + k]));
    }
  };
  look_around(footprint);
  const LevelShares shares = level_shares(grid, {.p = nudged});
  for (const int level : shares.level) look_around(make_footprint(grid, level, {.p = nudged}, Interpolation::tricubic));
  if (stored.form == GridForm::norms_and_directions) {
    // A mean of directions that point apart is short, and what it is off by grows when it is made a unit vector.
    float shortest = 1;
    for (std::size_t i = 18; i < 36; i += 3) {
      const float length = V3f(sum[i], sum[i + 1], sum[i + 2]).length();
      if (length > 0) shortest = std::min(shortest, length);
    }
    out.around /= shortest;
    out.largest /= shortest;
    sum = moments_from_compact(sum, grid.frame.direction_to_local(n));
  }
  out.e = irradiance(grid.basis, reconstruction, sum.data(), grid.frame.direction_to_local(n));
  return out;
}

// Points where rounding decides what a look-up reads, and how much weight it rests on elsewhere.
struct LookupMargin {
  bool undecided = false;
  float kept = 1;
};
inline LookupMargin margin_at(const IrradianceGrid& grid, int level, Guard guard, const LookupPoint& at,
                              Interpolation interpolation) {
  constexpr float closest_voxels = 1e-4F;  // float places points of this grid to 1e-6 of a voxel or so
  LookupMargin out;
  const GridFrame& frame = grid.frame_of(level);
  const V3f index = frame.to_index(at.nudged(frame));
  const V3f& spacing = frame.spacing_m;
  const V3f facing = frame.direction_to_local(at.ng) * spacing;
  const float behind_m = at.off_m(frame) + in_plane_voxels * std::min({spacing.x, spacing.y, spacing.z});
  // The footprint as the guard leaves it. `sign` moves weights up and down by far more than rounding does.
  const auto read = [&](Interpolation in, const Footprint* near, float sign) {
    Footprint f = make_footprint(grid, level, at, in);
    for (std::size_t i = 0; i < std::size_t(f.count); ++i)
      f.weight[i] *= 1 + sign * 1e-4F * float(i * 37 % std::size_t(f.count)) / float(f.count);
    const VisibleEntries seen = guard == Guard::planes ? visible_by_guard(grid, at, f, near) : VisibleEntries().set();
    const float kept = restrict_footprint(grid, seen, f);
    return std::pair(f, kept);
  };
  const auto judge = [&](Interpolation in, const Footprint* near) {
    const Footprint f = make_footprint(grid, level, at, in);
    for (std::size_t i = 0; i < std::size_t(f.count); ++i) {
      const std::uint32_t vertex = f.vertex[i];
      const V3f u = index - V3f(grid.place_of(vertex).at);
      const float hidden = guard == Guard::planes ? hidden_by(grid.guard[vertex], u) : -1;
      const float weight = f.weight[i] * vertex_trust(grid.visible_fraction[vertex]);
      if (weight > 0 && std::abs(hidden) < closest_voxels) out.undecided = true;
      const float behind = guard == Guard::planes ? facing.dot(u) - behind_m : -1;
      const float farthest = std::max({std::abs(u.x), std::abs(u.y), std::abs(u.z)});
      if (weight > 0 && hidden <= 0 && std::abs(behind) < closest_voxels * (1 + 1e-3F * farthest)) out.undecided = true;
    }
    const auto [kept_footprint, kept] = read(in, near, 0);
    // The least weight that counts is 1e-4.
    if (kept > 0 && kept < 2e-4F) out.undecided = true;
    for (const float sign : {-1.0F, 1.0F}) {
      const Footprint moved = read(in, near, sign).first;
      float change = 0;
      for (std::size_t i = 0; i < std::size_t(f.count); ++i)
        change += std::abs(moved.weight[i] - kept_footprint.weight[i]);
      if (change > 1e-3F) out.undecided = true;  // another witness was called
    }
    return std::pair(kept_footprint, kept);
  };
  // Of a tricubic footprint the trilinear one has the witnesses.
  auto near = judge(guard == Guard::planes ? Interpolation::trilinear : interpolation, nullptr);
  if (guard == Guard::planes && interpolation == Interpolation::tricubic) {
    const auto wide = judge(interpolation, near.second > 0 ? &near.first : nullptr);
    if (wide.second > 0) near = wide;  // else the trilinear one answers
  }
  out.kept = near.second;
  if (guard == Guard::planes && near.second < 0.26F && interpolation == Interpolation::trilinear)
    out.kept = std::max(near.second, judge(Interpolation::tricubic, near.second > 0 ? &near.first : nullptr).second);
  // Nothing is seen, and nothing divided.
  if (out.kept < 1e-4F) out.kept = 1;
  return out;
}

// By planes the point, or the closer one, is read: both, and which, must be decided.
inline LookupMargin margin_in_level(const IrradianceGrid& grid, int level, Guard guard, const LookupPoint& at,
                                    Interpolation interpolation) {
  LookupMargin out = margin_at(grid, level, guard, at, interpolation);
  if (guard != Guard::planes || at.ng == V3f(0, 0, 0) || at.nudge_voxels == 0) return out;
  const LookupPoint closer = closer_point(at);
  const GridFrame& frame = grid.frame_of(level);
  const V3f index = frame.to_index(closer.nudged(frame));
  Footprint seen = make_footprint(grid, level, at, Interpolation::trilinear);
  const float kept = restrict_footprint(grid, visible_by_guard(grid, at, seen), seen);
  for (std::size_t i = 0; kept > 0 && i < std::size_t(seen.count); ++i) {
    const float weight = seen.weight[i] * kept;
    const float hidden = hidden_by(grid.guard[seen.vertex[i]], index - V3f(grid.place_of(seen.vertex[i]).at));
    if (std::abs(weight - least_weight) < 2e-5F || (weight >= least_weight && std::abs(hidden) < 1e-4F))
      out.undecided = true;
  }
  const NearReading near = read_near(grid, level, at);
  if (kept > 0 && near.at.nudge_voxels == at.nudge_voxels && near.kept == kept) {
    // It was not moved; was the closer point asked and found unseen? Rounding must not let it be seen.
    Footprint again = make_footprint(grid, level, closer, Interpolation::trilinear);
    if (restrict_footprint(grid, visible_by_guard(grid, closer, again), again) > 0) return out;
  }
  const LookupMargin moved = margin_at(grid, level, guard, closer, interpolation);
  const bool is_moved = near.at.nudge_voxels != at.nudge_voxels;
  return {out.undecided || moved.undecided, is_moved ? moved.kept : out.kept};
}

inline LookupMargin margin(const IrradianceGrid& grid, Guard guard, const V3f& nudged, const V3f& ng, float off_m,
                           Interpolation interpolation) {
  const V3f& spacing = grid.frame.spacing_m;
  // Already off its surface, which the look-up would do from there.
  const LookupPoint at{
      .p = nudged - ng * off_m, .ng = ng, .nudge_voxels = off_m / std::min({spacing.x, spacing.y, spacing.z})};
  const LevelShares shares = level_shares(grid, at);
  LookupMargin out = margin_in_level(grid, shares.level[0], guard, at, interpolation);
  if (shares.share[1] == 0) return out;
  const LookupMargin other = margin_in_level(grid, shares.level[1], guard, at, interpolation);
  out.undecided = out.undecided || other.undecided || std::min(shares.share[0], shares.share[1]) < 1e-4F;
  // In the finer level, weights are divided by its share.
  out.kept = std::min(out.kept * shares.share[0], other.kept);
  return out;
}

}  // namespace ivory
