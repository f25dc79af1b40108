// What rays ask an intersector.
#include <limits>

#include "tracer/core/rays/state.h"

namespace ivory {
namespace {

// `lines` are for portable triangles, as many as rays are asked for at once; null without.
RayContext make_context(const Ray& ray, const Line* lines) {
  RayContext context{};
  context.lines = lines;
  rtcInitIntersectContext(&context.embree);
  context.coverage_seed = ray.coverage_seed;
  context.blocking_coverage = ray.blocking_coverage;
  if (ray.cull_back_faces) context.embree.filter = filter_back_faces;
  return context;
}

RTCRay make_ray(const Ray& ray) {
  const V3f& o = ray.origin;
  const V3f& d = ray.direction;
  return {o.x, o.y, o.z, ray.t_min, d.x, d.y, d.z, 0, ray.t_max, ~0U, 0, 0};
}

RTCRayHit make_query(const Ray& ray) {
  RTCRayHit query{};
  query.ray = make_ray(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return query;
}

}  // namespace

std::uint64_t Intersector::count_hits(std::span<const Ray> rays) const {
  std::uint64_t hits = 0;
  for (const Ray& ray : rays) {
    const Line line = state_->line_of(ray);
    RayContext context = make_context(ray, &line);
    RTCRayHit query = make_query(ray);
    rtcIntersect1(state_->top, &context.embree, &query);
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) ++hits;
  }
  return hits;
}

Hit Intersector::State::make_hit(float t, const RTCHit& met) const {
  const bool instanced = met.instID[0] != RTC_INVALID_GEOMETRY_ID;
  Hit hit;
  hit.t = t;
  hit.barycentric = {met.u, met.v};
  hit.instance = static_cast<int>(instanced ? met.instID[0] : met.geomID);
  hit.triangle = static_cast<int>(met.primID);
  V3f ng(met.Ng_x, met.Ng_y, met.Ng_z);
  // Embree's normal is that of the winding in the space it was built in; a transform of negative
  // determinant reverses glTF's winding rule, which keeps the front where the inverse transpose puts it.
  if (instanced) {
    ng = ng * normal_to_world[std::size_t(hit.instance)];
  } else if (records[std::size_t(hit.instance)].mirrored_build) {
    ng = -ng;
  }
  hit.ng = ng.normalized();
  return hit;
}

std::optional<Hit> Intersector::State::closest(const Ray& ray, RayContext& context) const {
  RTCRayHit query = make_query(ray);
  rtcIntersect1(top, &context.embree, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return make_hit(query.ray.tfar, query.hit);
}

std::optional<Hit> Intersector::closest(const Ray& ray) const {
  const Line line = state_->line_of(ray);
  RayContext context = make_context(ray, &line);
  return state_->closest(ray, context);
}

Passage Intersector::pass(const Ray& ray) const {
  Passage passage;
  if (!has_coverage()) {
    passage.end = closest(ray);
    return passage;
  }
  const Line line = state_->line_of(ray);
  RayContext context = make_context(ray, &line);
  PartHits part;
  context.part_hits = &part;
  passage.end = state_->closest(ray, context);
  for (; passage.count < part.count; ++passage.count) {
    const PartHit& met = part.nearest[passage.count];
    if (passage.end && met.t > passage.end->t) return passage;
    passage.crossed[passage.count] = {state_->make_hit(met.t, met.hit), met.coverage};
  }
  if (part.are_all) return passage;
  context.part_hits = nullptr;
  context.behind = &part.nearest.back();
  passage.end = state_->closest(ray, context);
  return passage;
}

float Intersector::transmittance(const Ray& ray) const {
  const Line line = state_->line_of(ray);
  RayContext context = make_context(ray, &line);
  RTCRay query = make_ray(ray);
  rtcOccluded1(state_->top, &context.embree, &query);
  return query.tfar < 0 ? 0 : context.transmittance;
}

std::array<float, 8> Intersector::distances(const std::array<V3f, 8>& origins, int count, const V3f& direction) const {
  alignas(32) std::array<int, 8> active{};
  RTCRayHit8 query;
  for (std::size_t i = 0; i < 8; ++i) {
    active[i] = static_cast<int>(i) < count ? -1 : 0;
    const V3f& origin = origins[i < std::size_t(count) ? i : 0];
    query.ray.org_x[i] = origin.x;
    query.ray.org_y[i] = origin.y;
    query.ray.org_z[i] = origin.z;
    query.ray.dir_x[i] = direction.x;
    query.ray.dir_y[i] = direction.y;
    query.ray.dir_z[i] = direction.z;
    query.ray.tnear[i] = 0;
    query.ray.tfar[i] = std::numeric_limits<float>::infinity();
    query.ray.time[i] = 0;
    query.ray.mask[i] = ~0U;
    query.ray.id[i] = unsigned(i);
    query.ray.flags[i] = 0;
    query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  std::array<Line, 8> lines;
  for (std::size_t i = 0; state_->portable && i < std::size_t(count); ++i) lines[i] = make_line(origins[i], direction);
  RayContext context = make_context({}, lines.data());
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  context.blocking_coverage = half_coverage;
  rtcIntersect8(active.data(), state_->top, &context.embree, &query);
  std::array<float, 8> out{};
  for (std::size_t i = 0; i < 8; ++i) {
    out[i] =
        query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? std::numeric_limits<float>::infinity() : query.ray.tfar[i];
  }
  return out;
}

std::uint32_t Intersector::visible(const V3f& origin, const std::array<V3f, 8>& targets, int count) const {
  alignas(32) std::array<int, 8> active{};
  RTCRay8 rays;
  std::array<Line, 8> lines;
  for (std::size_t i = 0; i < 8; ++i) {
    active[i] = static_cast<int>(i) < count ? -1 : 0;
    const V3f d = targets[i < std::size_t(count) ? i : 0] - origin;
    if (state_->portable && active[i] != 0) lines[i] = make_line(origin, d);
    rays.org_x[i] = origin.x;
    rays.org_y[i] = origin.y;
    rays.org_z[i] = origin.z;
    rays.dir_x[i] = d.x;
    rays.dir_y[i] = d.y;
    rays.dir_z[i] = d.z;
    rays.tnear[i] = 0;
    rays.tfar[i] = 1;
    rays.time[i] = 0;
    rays.mask[i] = ~0U;
    rays.id[i] = unsigned(i);
    rays.flags[i] = 0;
  }
  RayContext context = make_context({}, lines.data());
  context.blocking_coverage = half_coverage;
  rtcOccluded8(active.data(), state_->top, &context.embree, &rays);
  std::uint32_t bits = 0;
  for (int i = 0; i < count; ++i) {
    if (rays.tfar[i] >= 0) bits |= 1U << unsigned(i);
  }
  return bits;
}

}  // namespace ivory
