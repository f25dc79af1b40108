#include "tracer/render/gather/record.h"

#include <algorithm>
#include <cmath>

namespace ivory {

namespace {

// A record is a picture of its surroundings: it changes as one moves by a part of their distance.
constexpr float share_of_distance = 0.5F;
// Where light stands on the surface, beyond this share of the way to it nothing is taken over.
constexpr float share_of_free_way = 0.9F;
// Gradients are kept from more than this share of E at the radius: there they are noise, or no plane.
constexpr float most_change = 0.7F;
// A step off the record's plane counts as so long a way along it.
constexpr float off_plane = 4;
constexpr float least_cosine = 0.9063F;  // 25 degrees

}  // namespace

IrradianceRecord make_record(const V3f& p, const V3f& n, const Hemisphere& hemisphere, const RecordLimits& limits) {
  const HemisphereIrradiance found = irradiance_of(hemisphere);
  IrradianceRecord r;
  r.p = p;
  r.n = n;
  r.tangent[0] = hemisphere.frame.x;
  r.tangent[1] = hemisphere.frame.y;
  r.e = found.e;
  V3f change(0, 0, 0);
  constexpr float y[3] = {0.2126F, 0.7152F, 0.0722F};
  for (int c = 0; c < 3; ++c) {
    r.vector[c] = found.vector[c];
    r.gradient[c] = found.gradient[c];
    change += found.gradient[c] * y[c];
  }
  // |second derivatives| d^2 / 2 at distance d is what a linear field leaves out.
  const float scale = luminance(r.e) + limits.floor_lux;
  float radius = std::min(limits.most_radius_m, share_of_distance * found.harmonic_distance_m);
  if (found.bend > 0) radius = std::min(radius, std::sqrt(2 * limits.error * scale / found.bend));
  const float slope = change.length();
  if (slope > 0) radius = std::min(radius, most_change * scale / slope);
  r.radius_m = std::max(radius, limits.least_radius_m);
  // In contacts, where a record is larger than its gradient bears, the gradient gives way; by the record's own E,
  // beside which errors of dark places are seen even where most of the picture is lit.
  if (const float most = most_change * luminance(r.e) / r.radius_m; slope > most) {
    for (V3f& gradient : r.gradient) gradient *= most / slope;
  }
  for (int k = 0; k < coarse_sectors; ++k) {
    r.reach_inverse_m[k] =
        std::min(found.free_inverse_m[k] / share_of_free_way, 1 / std::max(limits.least_radius_m, 1e-30F));
  }
  return r;
}

float weight(const IrradianceRecord& r, const V3f& p, const V3f& n) {
  const float cosine = n.dot(r.n);
  if (cosine <= least_cosine) return 0;
  const V3f d = p - r.p;
  const float off = d.dot(r.n);
  const float distance2 = d.length2() + (off_plane * off_plane - 1) * off * off;
  if (distance2 >= r.radius_m * r.radius_m) return 0;
  const float distance = std::sqrt(distance2);
  float inverse_m = 1 / r.radius_m;
  // Between the middles of two sectors.
  const float turns = std::atan2(d.dot(r.tangent[1]), d.dot(r.tangent[0])) * (1 / (2 * pi));
  const float sector = (turns < 0 ? turns + 1 : turns) * coarse_sectors - 0.5F;
  const float below = std::floor(sector);
  const float share = sector - below;
  const int k = (int(below) + coarse_sectors) % coarse_sectors;
  const float reach = r.reach_inverse_m[k] * (1 - share) + r.reach_inverse_m[(k + 1) % coarse_sectors] * share;
  inverse_m = std::max(inverse_m, reach);
  const float near = 1 - distance * inverse_m;
  if (near <= 0) return 0;
  const float aligned = (cosine - least_cosine) / (1 - least_cosine);
  return near * std::min(1.0F, aligned);
}

Rgb irradiance(const IrradianceRecord& r, const V3f& p, const V3f& ns) {
  // Turning the normal cuts a wedge off the hemisphere that cosines weigh: n.I is right in the first order, and light
  // from all around, of which E (1 + cos) / 2 arrives in the part that both normals face, in all.
  const V3f d = p - r.p;
  const float wedge = (1 - ns.dot(r.n)) / 2;
  Rgb e;
  for (int c = 0; c < 3; ++c) e[c] = std::max(0.0F, ns.dot(r.vector[c]) + r.e[c] * wedge + r.gradient[c].dot(d));
  return e;
}

}  // namespace ivory
