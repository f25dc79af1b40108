#include "grid/lobes/sphere_set.h"

#include <algorithm>

namespace ivory {

namespace {

constexpr std::size_t group_size = 8;

Sphere bounds_of(const std::vector<Sphere>& spheres, std::size_t first, std::size_t count) {
  Box3f box;
  for (std::size_t i = first; i < first + count; ++i) {
    const V3f r(spheres[i].radius_m, spheres[i].radius_m, spheres[i].radius_m);
    box.extendBy(spheres[i].center - r);
    box.extendBy(spheres[i].center + r);
  }
  Sphere bounds{box.center(), 0};
  for (std::size_t i = first; i < first + count; ++i)
    bounds.radius_m = std::max(bounds.radius_m, (spheres[i].center - bounds.center).length() + spheres[i].radius_m);
  // Rounding, also far from the origin: a group too large costs little, one too small a shadow.
  const float far_out = std::max({std::abs(box.min.x), std::abs(box.min.y), std::abs(box.min.z), std::abs(box.max.x),
                                  std::abs(box.max.y), std::abs(box.max.z)});
  bounds.radius_m = bounds.radius_m * 1.0001F + far_out * 1e-6F;
  return bounds;
}

// Halves along the widest side of the centres' box, down to groups.
void split(SphereGroups& result, std::size_t first, std::size_t count) {
  if (count <= group_size) {
    result.groups.push_back({bounds_of(result.spheres, first, count), std::uint32_t(first), std::uint32_t(count)});
    return;
  }
  Box3f box;
  for (std::size_t i = first; i < first + count; ++i) box.extendBy(result.spheres[i].center);
  const unsigned axis = box.majorAxis();
  const auto begin = result.spheres.begin() + std::ptrdiff_t(first);
  const std::size_t half = (count / 2 + group_size - 1) / group_size * group_size;
  std::nth_element(begin, begin + std::ptrdiff_t(half), begin + std::ptrdiff_t(count),
                   [axis](const Sphere& a, const Sphere& b) { return a.center[axis] < b.center[axis]; });
  split(result, first, half);
  split(result, first + half, count - half);
}

}  // namespace

SphereGroups make_sphere_groups(std::vector<Sphere> spheres) {
  SphereGroups result;
  result.spheres = std::move(spheres);
  if (!result.spheres.empty()) split(result, 0, result.spheres.size());
  return result;
}

void find_hiding(const SphereGroups& groups, const Cone& cone, std::vector<Sphere>& found) {
  found.clear();
  for (const SphereGroups::Group& group : groups.groups) {
    if (!may_hide(group.bounds, cone)) continue;
    for (std::uint32_t i = group.first; i < group.first + group.count; ++i) {
      const Sphere& sphere = groups.spheres[i];
      if (may_hide(sphere, cone) && power(sphere, cone.apex) > 0) found.push_back(sphere);
    }
  }
}

}  // namespace ivory
