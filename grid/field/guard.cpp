#include "grid/field/guard.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "grid/field/kernels.h"
#include "grid/field/yield.h"

namespace ivory {
namespace {

constexpr float normal_steps = 1023;
constexpr float distance_range = 2;  // voxels; the far corner of the support is sqrt(3) away
constexpr float distance_steps = 4095;

float sign_not_zero(float x) { return x < 0 ? -1.0F : 1.0F; }

}  // namespace

// Octahedral mapping after Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT
// 2014.
std::uint32_t pack(const GuardPlane& plane) {
  const V3f& n = plane.normal;
  const float scale = 1 / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  float x = n.x * scale;
  float y = n.y * scale;
  if (n.z < 0) {
    const float folded = (1 - std::abs(y)) * sign_not_zero(x);
    y = (1 - std::abs(x)) * sign_not_zero(y);
    x = folded;
  }
  const auto quantise = [](float v, float steps) {
    return static_cast<std::uint32_t>(std::lrint(std::clamp(v, 0.0F, 1.0F) * steps));
  };
  // Distance counts from one, which keeps the word from being zero.
  const std::uint32_t distance =
      1 + quantise((plane.distance + distance_range) / (2 * distance_range), distance_steps - 1);
  return quantise(x * 0.5F + 0.5F, normal_steps) | quantise(y * 0.5F + 0.5F, normal_steps) << 10U | distance << 20U;
}

namespace {

kernels::Plane<float> plane_in(std::uint32_t word) {
  return kernels::plane_of(static_cast<float>(word & 1023U), static_cast<float>((word >> 10U) & 1023U),
                           static_cast<float>(word >> 20U));
}

}  // namespace

std::optional<GuardPlane> unpack(std::uint32_t word) {
  if (word < no_guard_plane) return std::nullopt;
  const kernels::Plane<float> plane = plane_in(word);
  return GuardPlane{V3f(plane.normal[0], plane.normal[1], plane.normal[2]), plane.distance};
}

float hidden_by(const GuardRecord& record, const V3f& u) {
  float most = -std::numeric_limits<float>::max();
  for (const std::uint32_t word : record.words) {
    if (word >= no_guard_plane) most = std::max(most, plane_in(word).beyond({u.x, u.y, u.z}));
  }
  return most;
}

VisibleEntries visible_by_guard(const IrradianceGrid& grid, const LookupPoint& at, const Footprint& footprint,
                                const Footprint* near) {
  VisibleEntries visible;
  VisibleEntries in_front;
  if (grid.guard.empty()) return visible.set();
  if (footprint.count == 0) return visible;
  const GridFrame& frame = grid.frame_of(grid.level_of(footprint.vertex[0]));
  const V3f index = frame.to_index(at.nudged(frame));
  const V3f& spacing = frame.spacing_m;
  const V3f facing = frame.direction_to_local(at.ng) * spacing;  // times voxels: metres along ng
  const float behind_m = at.off_m(frame) + in_plane_voxels * std::min({spacing.x, spacing.y, spacing.z});
  const bool at_surface = at.ng != V3f(0, 0, 0);
  for (std::size_t i = 0; i < std::size_t(footprint.count); ++i) {
    const std::uint32_t vertex = footprint.vertex[i];
    if (footprint.weight[i] == 0 || grid.visible_fraction[vertex] <= 0) continue;
    const V3f u = index - V3f(grid.place_of(vertex).at);
    const bool behind = facing.dot(u) > behind_m;
    if (footprint.wide && behind) continue;
    in_front[i] = at_surface && !behind;
    visible[i] = hidden_by(grid.guard[vertex], u) <= 0;
  }
  return footprint.wide ? yield_wide(grid, footprint, visible, in_front, near)
                        : yield_near(grid, footprint, visible, in_front);
}

}  // namespace ivory
