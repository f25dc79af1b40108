#include "grid/fiv/set.h"

#include <cmath>

namespace ivory {

std::optional<FivBlend> blend_of_turn(int count, double turn_rad) {
  constexpr double whole = 2 * 3.14159265358979323846;
  constexpr double tolerance_rad = 1e-4;
  const double within = std::remainder(turn_rad, whole);
  if (count == 1) return std::abs(within) <= tolerance_rad ? std::optional(FivBlend{}) : std::nullopt;
  const double at = (within < 0 ? within + whole : within) / whole * count;
  // What is turned by rounding alone needs one table.
  const double nearest = std::round(at);
  if (std::abs(at - nearest) * whole <= tolerance_rad * count) {
    const int only = int(nearest) % count;
    return FivBlend{only, only, 0};
  }
  const int first = int(at) % count;
  return FivBlend{first, (first + 1) % count, float(at - std::floor(at))};
}

std::optional<FivPlacement> turned_placement(const FivSet& set, const FivPlacement& at, double turn_rad) {
  const std::optional<FivBlend> blend = blend_of_turn(int(set.turns.size()), turn_rad);
  if (!blend) return std::nullopt;
  FivPlacement placement = at;
  placement.table = &set.turns[std::size_t(blend->first)];
  placement.next = blend->share > 0 ? &set.turns[std::size_t(blend->second)] : nullptr;
  placement.next_share = blend->share;
  return placement;
}

}  // namespace ivory
