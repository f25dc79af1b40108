#include "grid/field/irradiance_grid.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "grid/base/anchor.h"

namespace ivory {

namespace {

// Vertices and weights that one axis contributes: two for linear interpolation, four for the cubic B-spline. Outside
// the grid the nearest vertex is repeated.
struct AxisFootprint {
  std::array<int, 4> index;
  std::array<float, 4> weight;
};

AxisFootprint axis_footprint(float x, int size, Interpolation interpolation) {
  AxisFootprint axis{};
  const float clamped = std::clamp(x, 0.0F, static_cast<float>(size - 1));
  const int base = std::min(static_cast<int>(clamped), size - 2);
  const float t = clamped - static_cast<float>(base);
  if (interpolation == Interpolation::trilinear) {
    axis.index = {base, base + 1, 0, 0};
    axis.weight = {1 - t, t, 0, 0};
    return axis;
  }
  const float s = 1 - t;
  for (int i = 0; i < 4; ++i) axis.index[std::size_t(i)] = std::clamp(base - 1 + i, 0, size - 1);
  axis.weight = {s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6,
                 t * t * t / 6};
  return axis;
}

}  // namespace

void set_anchor(GridVertices& grid, const V3d& anchor_m) {
  GridFrame frame = grid.frame;
  frame.origin_m = to_local(to_world(frame.origin_m, grid.anchor_m), anchor_m);
  set_frame(grid, frame);
  grid.anchor_m = anchor_m;
}

Footprint make_footprint(const GridFrame& frame, const V3f& p, Interpolation interpolation) {
  assert(interpolation != Interpolation::fitted);
  const V3f index = frame.to_index(p);
  const std::array<AxisFootprint, 3> axes{axis_footprint(index.x, frame.size.x, interpolation),
                                          axis_footprint(index.y, frame.size.y, interpolation),
                                          axis_footprint(index.z, frame.size.z, interpolation)};
  const std::size_t width = interpolation == Interpolation::trilinear ? 2 : 4;
  Footprint footprint;
  footprint.wide = width == 4;
  for (std::size_t k = 0; k < width; ++k) {
    for (std::size_t j = 0; j < width; ++j) {
      const float weight_jk = axes[2].weight[k] * axes[1].weight[j];
      for (std::size_t i = 0; i < width; ++i) {
        const auto entry = std::size_t(footprint.count++);
        footprint.vertex[entry] =
            static_cast<std::uint32_t>(frame.vertex_index(axes[0].index[i], axes[1].index[j], axes[2].index[k]));
        footprint.weight[entry] = weight_jk * axes[0].weight[i];
      }
    }
  }
  return footprint;
}

namespace {

template <std::size_t width>
Footprint make_brick_footprint(const BrickLevel& level, const V3f& p, Interpolation interpolation) {
  const V3f index = level.frame.to_index(p);
  const V3i& size = level.frame.size;
  const std::array<AxisFootprint, 3> axes{axis_footprint(index.x, size.x, interpolation),
                                          axis_footprint(index.y, size.y, interpolation),
                                          axis_footprint(index.z, size.z, interpolation)};
  Footprint footprint;
  footprint.wide = width == 4;
  float stored = 0;
  for (std::size_t k = 0; k < width; ++k) {
    for (std::size_t j = 0; j < width; ++j) {
      const float weight_jk = axes[2].weight[k] * axes[1].weight[j];
      for (std::size_t i = 0; i < width; ++i) {
        const std::uint32_t vertex = level.vertex_at({axes[0].index[i], axes[1].index[j], axes[2].index[k]});
        if (vertex >= no_brick) continue;
        const auto entry = std::size_t(footprint.count++);
        footprint.vertex[entry] = vertex;
        footprint.weight[entry] = weight_jk * axes[0].weight[i];
        stored += footprint.weight[entry];
      }
    }
  }
  if (footprint.count == int(width * width * width)) return footprint;
  if (!(stored > 0)) footprint.count = 0;
  for (std::size_t i = 0; i < std::size_t(footprint.count); ++i) footprint.weight[i] /= stored;
  return footprint;
}

// The trilinear weight of those of the point's vertices that the level stores.
float stored_weight(const BrickLevel& level, const V3f& p) {
  const V3f index = level.frame.to_index(p);
  V3i base;
  std::array<std::array<float, 2>, 3> weight;
  bool in_one_brick = true;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const AxisFootprint along = axis_footprint(index[axis], level.frame.size[axis], Interpolation::trilinear);
    base[axis] = along.index[0];
    weight[axis] = {along.weight[0], along.weight[1]};
    in_one_brick = in_one_brick && (base[axis] & 3) != 3;
  }
  const std::uint32_t first = level.vertex_at(base);
  if (in_one_brick) return first < no_brick ? 1.0F : 0.0F;
  if (first >= no_brick + 2) return 0;  // nor are the bricks around it
  float stored = 0;
  bool is_whole = true;
  for (int corner = 0; corner < 8; ++corner) {
    const V3i side(corner & 1, corner >> 1 & 1, corner >> 2);
    if (level.vertex_at(base + side) < no_brick) {
      stored += weight[2][std::size_t(side.z)] * weight[1][std::size_t(side.y)] * weight[0][std::size_t(side.x)];
    } else {
      is_whole = false;
    }
  }
  return is_whole ? 1 : stored;
}

void append(const Footprint& part, float scale, Footprint& out) {
  for (std::size_t i = 0; i < std::size_t(part.count); ++i) {
    if (part.weight[i] == 0) continue;
    out.vertex[std::size_t(out.count)] = part.vertex[i];
    out.weight[std::size_t(out.count++)] = part.weight[i] * scale;
  }
}

}  // namespace

LevelShares level_shares(const Lattice& lattice, const LookupPoint& at) {
  LevelShares out;
  for (int level = int(lattice.finer.size()); level > 0; --level) {
    const BrickLevel& bricks = lattice.finer[std::size_t(level - 1)];
    const float stored = stored_weight(bricks, at.nudged(bricks.frame));
    if (stored <= 0) continue;
    if (out.share[1] > 0) {  // what the finer level leaves over
      out.level[1] = level;
      return out;
    }
    out.level[0] = level;
    out.share = {stored, 1 - stored};
    if (stored >= 1) return out;
  }
  return out;
}

Footprint make_footprint(const Lattice& lattice, int level, const LookupPoint& at, Interpolation interpolation) {
  const V3f p = at.nudged(lattice.frame_of(level));
  if (level == 0) return make_footprint(lattice.frame, p, interpolation);
  const BrickLevel& bricks = lattice.finer[std::size_t(level - 1)];
  return interpolation == Interpolation::trilinear ? make_brick_footprint<2>(bricks, p, interpolation)
                                                   : make_brick_footprint<4>(bricks, p, interpolation);
}

Footprint make_footprint(const Lattice& lattice, const LookupPoint& at, Interpolation interpolation) {
  const LevelShares shares = level_shares(lattice, at);
  if (shares.share[1] <= 0) return make_footprint(lattice, shares.level[0], at, interpolation);
  return blend(make_footprint(lattice, shares.level[0], at, interpolation),
               make_footprint(lattice, shares.level[1], at, interpolation), shares.share[0]);
}

float vertex_trust(float visible_fraction) {
  constexpr float full_trust = 0.25F;
  return std::min(1.0F, visible_fraction / full_trust);
}

float restrict_footprint(const IrradianceGrid& grid, const VisibleEntries& visible, Footprint& footprint) {
  std::array<float, max_footprint> trusted;
  float kept = 0;
  for (std::size_t i = 0; i < std::size_t(footprint.count); ++i) {
    const float fraction = visible[i] ? grid.visible_fraction[footprint.vertex[i]] : 0;
    trusted[i] = footprint.weight[i] * vertex_trust(fraction);
    kept += trusted[i];
  }
  if (kept < least_weight) return 0;
  for (std::size_t i = 0; i < std::size_t(footprint.count); ++i) footprint.weight[i] = trusted[i] / kept;
  return kept;
}

Footprint blend(const Footprint& a, const Footprint& b, float share) {
  Footprint out;
  append(a, share, out);
  append(b, 1 - share, out);
  return out;
}

namespace {

// A stride known at compile time lets the sum stay in vector registers.
template <std::size_t stride>
Rgb irradiance_of(const IrradianceGrid& grid, const Footprint& footprint, const V3f& n, Reconstruction reconstruction) {
  std::array<float, stride> moments{};
  for (std::size_t entry = 0; entry < std::size_t(footprint.count); ++entry) {
    const float weight = footprint.weight[entry];
    const float* vertex = grid.moments.data() + footprint.vertex[entry] * stride;
    for (std::size_t i = 0; i < stride; ++i) moments[i] += weight * vertex[i];
  }
  const Rgb e = irradiance(grid.basis, reconstruction, moments.data(), grid.frame.direction_to_local(n));
  // Weights of either sign can leave moments that no light has.
  return {std::max(e.x, 0.0F), std::max(e.y, 0.0F), std::max(e.z, 0.0F)};
}

}  // namespace

Rgb irradiance(const IrradianceGrid& grid, const Footprint& footprint, const V3f& n, Reconstruction reconstruction) {
  switch (function_count(grid.basis)) {
    case 12:
      return irradiance_of<36>(grid, footprint, n, reconstruction);
    case 9:
      return irradiance_of<27>(grid, footprint, n, reconstruction);
    case 6:
      return irradiance_of<18>(grid, footprint, n, reconstruction);
    default:
      return irradiance_of<12>(grid, footprint, n, reconstruction);
  }
}

Rgb irradiance_standard_error(const IrradianceGrid& grid, const Footprint& footprint, float unmet_lux) {
  Rgb variance(0, 0, 0);
  for (int entry = 0; entry < footprint.count; ++entry) {
    const float weight = footprint.weight[std::size_t(entry)];
    const std::uint32_t vertex = footprint.vertex[std::size_t(entry)];
    const Rgb& of_vertex = grid.variance[vertex];
    const float unmet = std::ldexp(unmet_lux, 2 * grid.level_of(vertex));
    variance += (is_black(of_vertex) ? Rgb(1, 1, 1) * (unmet * unmet) : of_vertex) * (weight * weight);
  }
  return {std::sqrt(variance.x), std::sqrt(variance.y), std::sqrt(variance.z)};
}

}  // namespace ivory
