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

using AxisFootprints = std::array<AxisFootprint, 3>;

// A level's part of a footprint: appends `share` of each weight whose vertex is stored, and returns what is left over.
template <std::size_t width, typename VertexAt>
float append_level(const AxisFootprints& axes, float share, const VertexAt& vertex_at, Footprint& footprint) {
  float left = 0;
  for (std::size_t k = 0; k < width; ++k) {
    for (std::size_t j = 0; j < width; ++j) {
      const float weight_jk = share * axes[2].weight[k] * axes[1].weight[j];
      for (std::size_t i = 0; i < width; ++i) {
        const float weight = weight_jk * axes[0].weight[i];
        const std::uint32_t vertex = vertex_at(axes[0].index[i], axes[1].index[j], axes[2].index[k]);
        if (vertex >= no_brick) {
          left += weight;
          continue;
        }
        const auto entry = std::size_t(footprint.count++);
        footprint.vertex[entry] = vertex;
        footprint.weight[entry] = weight;
      }
    }
  }
  return left;
}

template <std::size_t width>
Footprint make_brick_footprint(const Lattice& lattice, const LookupPoint& at, Interpolation interpolation) {
  Footprint footprint;
  footprint.wide = width == 4;
  float share = 1;
  for (int level = lattice.levels() - 1; level >= 0 && share > 0; --level) {
    const GridFrame& frame = lattice.frame_of(level);
    const V3f index = frame.to_index(at.nudged(frame));
    const AxisFootprints axes{axis_footprint(index.x, frame.size.x, interpolation),
                              axis_footprint(index.y, frame.size.y, interpolation),
                              axis_footprint(index.z, frame.size.z, interpolation)};
    if (level == 0) {
      append_level<width>(
          axes, share, [&](int i, int j, int k) { return std::uint32_t(frame.vertex_index(i, j, k)); }, footprint);
      break;
    }
    const BrickLevel& bricks = lattice.finer[std::size_t(level - 1)];
    const V3i first(axes[0].index[0], axes[1].index[0], axes[2].index[0]);
    if (bricks.vertex_at(first) > no_brick + 1) continue;  // no stored brick is near
    share = append_level<width>(
        axes, share,
        [&](int i, int j, int k) {
          return bricks.vertex_at({i, j, k});
        },
        footprint);
  }
  return footprint;
}

}  // namespace

Footprint make_footprint(const Lattice& lattice, const LookupPoint& at, Interpolation interpolation) {
  if (lattice.finer.empty()) return make_footprint(lattice.frame, at.nudged(lattice.frame), interpolation);
  return interpolation == Interpolation::trilinear ? make_brick_footprint<2>(lattice, at, interpolation)
                                                   : make_brick_footprint<4>(lattice, at, interpolation);
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
  const auto append = [&](const Footprint& part, float scale) {
    for (std::size_t i = 0; i < std::size_t(part.count); ++i) {
      if (part.weight[i] == 0) continue;
      out.vertex[std::size_t(out.count)] = part.vertex[i];
      out.weight[std::size_t(out.count++)] = part.weight[i] * scale;
    }
  };
  append(a, share);
  append(b, 1 - share);
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
