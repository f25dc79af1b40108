#include "tracer/core/intersector_filters.h"

#include <algorithm>
#include <cassert>

#include "tracer/core/surface.h"

namespace ivory {

namespace {

// Uniform in [0,1) from the ray's seed and the surface met: one ray asks about one surface several
// times and must get one answer. The mixing is splitmix64's finalizer.
float coverage_threshold(std::uint32_t seed, unsigned geometry, unsigned primitive) {
  std::uint64_t x = (std::uint64_t(seed) << 32U) ^ (std::uint64_t(geometry) * 0x9E3779B97F4A7C15U) ^ primitive;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  x ^= x >> 31U;
  return static_cast<float>(x >> 40U) * 0x1p-24F;
}

float coverage_of(const RTCFilterFunctionNArguments& args, const GeometryRecord& record, unsigned lane) {
  const float u = RTCHitN_u(args.hit, args.N, lane);
  const float v = RTCHitN_v(args.hit, args.N, lane);
  const auto triangle = static_cast<int>(RTCHitN_primID(args.hit, args.N, lane));
  return coverage_at(*record.scene, record.mesh, triangle, V2f(u, v));
}

}  // namespace

void filter_closest(const RTCFilterFunctionNArguments* args) {
  const auto& record = *static_cast<const GeometryRecord*>(args->geometryUserPtr);
  const auto& context = *reinterpret_cast<const RayContext*>(args->context);
  if (context.blocking_coverage >= 0) {
    for (unsigned lane = 0; lane < args->N; ++lane) {
      if (args->valid[lane] != 0 && coverage_of(*args, record, lane) < context.blocking_coverage) args->valid[lane] = 0;
    }
    return;
  }
  assert(args->N == 1);
  const float coverage = coverage_of(*args, record, 0);
  const bool there = coverage >= 1 || coverage > coverage_threshold(context.coverage_seed,
                                                                    RTCHitN_instID(args->hit, 1, 0, 0) * 31U +
                                                                        RTCHitN_geomID(args->hit, 1, 0),
                                                                    RTCHitN_primID(args->hit, 1, 0));
  if (!there) args->valid[0] = 0;
}

// Direction and normal are both in the space that the geometry was built in, so their product has the world's sign.
void filter_back_faces(const RTCFilterFunctionNArguments* args) {
  assert(args->N == 1);
  const auto& record = *static_cast<const GeometryRecord*>(args->geometryUserPtr);
  if (!record.single_sided) return;
  const V3f direction(RTCRayN_dir_x(args->ray, 1, 0), RTCRayN_dir_y(args->ray, 1, 0), RTCRayN_dir_z(args->ray, 1, 0));
  const V3f ng(RTCHitN_Ng_x(args->hit, 1, 0), RTCHitN_Ng_y(args->hit, 1, 0), RTCHitN_Ng_z(args->hit, 1, 0));
  if ((direction.dot(ng) > 0) != record.mirrored_build) args->valid[0] = 0;
}

void filter_occluded(const RTCFilterFunctionNArguments* args) {
  const auto& record = *static_cast<const GeometryRecord*>(args->geometryUserPtr);
  auto& context = *reinterpret_cast<RayContext*>(args->context);
  for (unsigned lane = 0; lane < args->N; ++lane) {
    if (args->valid[lane] == 0) continue;
    const float coverage = coverage_of(*args, record, lane);
    if (context.blocking_coverage >= 0) {
      if (coverage < context.blocking_coverage) args->valid[lane] = 0;
      continue;
    }
    context.transmittance *= std::max(0.0F, 1 - coverage);
    if (context.transmittance > 0) args->valid[lane] = 0;
  }
}

}  // namespace ivory
