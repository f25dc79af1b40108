#include "tracer/render/gather/cache.h"

#include <algorithm>
#include <cmath>

namespace ivory {

namespace {

constexpr int deepest = 24;

int octant_of(const V3f& p, const V3f& center) {
  return (p.x >= center.x ? 1 : 0) | (p.y >= center.y ? 2 : 0) | (p.z >= center.z ? 4 : 0);
}
V3f child_center(const V3f& center, float quarter, int octant) {
  return center + V3f((octant & 1) != 0 ? quarter : -quarter, (octant & 2) != 0 ? quarter : -quarter,
                      (octant & 4) != 0 ? quarter : -quarter);
}

}  // namespace

IrradianceCache::IrradianceCache(const V3f& center, float radius_m)
    : center_(center), half_(std::max(radius_m, 1e-6F) * 1.01F), nodes_(1) {}

// Down to nodes of two to four radii, of which a sphere meets eight at most.
void IrradianceCache::insert(std::uint32_t node, const V3f& center, float half, const Entry& entry, float radius_m) {
  if (half < 2 * radius_m) {
    nodes_[node].entries.push_back(entry);
    return;
  }
  const float quarter = half / 2;
  for (int i = 0; i < 8; ++i) {
    const V3f middle = child_center(center, quarter, i);
    const V3f apart = entry.p - middle;
    if (std::max({std::abs(apart.x), std::abs(apart.y), std::abs(apart.z)}) > quarter + radius_m) continue;
    if (nodes_[node].child[std::size_t(i)] == 0) {
      nodes_[node].child[std::size_t(i)] = std::uint32_t(nodes_.size());
      nodes_.emplace_back();
    }
    insert(nodes_[node].child[std::size_t(i)], middle, quarter, entry, radius_m);
  }
}

template <typename Visit>
void IrradianceCache::visit(const V3f& p, const Visit& see) const {
  std::uint32_t node = 0;
  V3f center = center_;
  float half = half_;
  do {
    for (const Entry& entry : nodes_[node].entries) {
      if ((p - entry.p).length2() < entry.radius2) see(entry.record);
    }
    const int octant = octant_of(p, center);
    node = nodes_[node].child[std::size_t(octant)];
    half /= 2;
    center = child_center(center, half, octant);
  } while (node != 0);
}

void IrradianceCache::add(IrradianceRecord record, float least_radius_m) {
  visit(record.p, [&](std::uint32_t i) {
    const IrradianceRecord& other = records_[i];
    if (other.n.dot(record.n) < 0.5F) return;
    record.radius_m = std::min(record.radius_m, other.radius_m + (other.p - record.p).length());
  });
  record.radius_m = std::max(record.radius_m, least_radius_m);
  visit(record.p, [&](std::uint32_t i) {
    IrradianceRecord& other = records_[i];
    if (other.n.dot(record.n) < 0.5F) return;
    other.radius_m = std::min(other.radius_m, record.radius_m + (other.p - record.p).length());
  });
  const Entry entry{record.p, record.radius_m * record.radius_m, std::uint32_t(records_.size())};
  const float radius_m = std::clamp(record.radius_m, half_ * std::ldexp(1.0F, -deepest), half_ / 2);
  records_.push_back(record);
  insert(0, center_, half_, entry, radius_m);
}

float IrradianceCache::coverage(const Surface& surface) const {
  float sum = 0;
  visit(surface.p, [&](std::uint32_t i) { sum += weight(records_[i], surface.p, surface.ng); });
  return sum;
}

std::optional<Rgb> IrradianceCache::irradiance(const Surface& surface) const {
  float sum = 0;
  Rgb e(0, 0, 0);
  visit(surface.p, [&](std::uint32_t i) {
    const float w = weight(records_[i], surface.p, surface.ng);
    if (w <= 0) return;
    sum += w;
    e += ivory::irradiance(records_[i], surface.p, surface.ns) * w;
  });
  if (sum < least_coverage) return std::nullopt;
  return e / sum;
}

}  // namespace ivory
