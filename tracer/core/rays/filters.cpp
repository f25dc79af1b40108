#include "tracer/core/rays/filters.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <optional>

#include "tracer/core/surface.h"

namespace ivory {

namespace {

constexpr std::uint64_t golden = 0x9E3779B97F4A7C15U;

// The finalizer of splitmix64: a bijection whose output bits each depend on all input bits.
std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

float coverage_of(const RTCFilterFunctionNArguments& args, const GeometryRecord& record, unsigned lane) {
  const float u = RTCHitN_u(args.hit, args.N, lane);
  const float v = RTCHitN_v(args.hit, args.N, lane);
  const auto triangle = static_cast<int>(RTCHitN_primID(args.hit, args.N, lane));
  return coverage_at(*record.scene, record.mesh, triangle, V2f(u, v));
}

// The scene's instance that lane's hit belongs to. Meshes placed once are top-level geometry, by the same numbers.
unsigned instance_of(const RTCFilterFunctionNArguments& args, unsigned lane) {
  const unsigned instance = RTCHitN_instID(args.hit, args.N, lane, 0);
  return instance != RTC_INVALID_GEOMETRY_ID ? instance : RTCHitN_geomID(args.hit, args.N, lane);
}

// A point belongs to an edge where a corner weighs no more than this; Embree finds weights to 1e-7 or so.
constexpr float edge_width = 0x1p-20F;

std::uint64_t position_key(const V3f& p) {
  // Adding zero makes one of the two zeros.
  const auto bits = [](float x) { return std::uint64_t(std::bit_cast<std::uint32_t>(x + 0.0F)); };
  return mix(mix(bits(p.x) << 32U | bits(p.y)) + golden + bits(p.z));
}

// What lane's ray meets: the edge or corner that its hit lies on, which all triangles there share, and nothing where it
// lies inside of one triangle. Embree's robust rays meet both triangles of an edge, so that none slips through.
std::optional<std::uint64_t> shared_key(const RTCFilterFunctionNArguments& args, const GeometryRecord& record,
                                        unsigned lane) {
  const float u = RTCHitN_u(args.hit, args.N, lane);
  const float v = RTCHitN_v(args.hit, args.N, lane);
  const V3f weights(1 - u - v, u, v);
  if (std::min({weights.x, weights.y, weights.z}) > edge_width) return std::nullopt;
  const Mesh& mesh = record.scene->meshes[std::size_t(record.mesh)];
  const auto& corners = mesh.triangles[RTCHitN_primID(args.hit, args.N, lane)];
  std::uint64_t sum = instance_of(args, lane);
  for (unsigned i = 0; i < 3; ++i) {
    if (weights[i] > edge_width) sum += position_key(mesh.positions[corners[i]]);  // in whatever order
  }
  return mix(sum);
}

// Direction and normal are both in the space that the geometry was built in, so their product has the world's sign.
bool is_culled(const RTCFilterFunctionNArguments& args, const GeometryRecord& record) {
  if (!record.single_sided) return false;
  const V3f direction(RTCRayN_dir_x(args.ray, 1, 0), RTCRayN_dir_y(args.ray, 1, 0), RTCRayN_dir_z(args.ray, 1, 0));
  const V3f ng(RTCHitN_Ng_x(args.hit, 1, 0), RTCHitN_Ng_y(args.hit, 1, 0), RTCHitN_Ng_z(args.hit, 1, 0));
  return (direction.dot(ng) > 0) != record.mirrored_build;
}

bool comes_before(const PartHit& a, const PartHit& b) { return a.t != b.t ? a.t < b.t : a.key < b.key; }

}  // namespace

void PartHits::add(const PartHit& hit) {
  const auto end = nearest.begin() + std::ptrdiff_t(count);
  // Embree may ask twice about one surface.
  if (std::any_of(nearest.begin(), end, [&](const PartHit& other) { return other.key == hit.key; })) return;
  const auto at = std::find_if(nearest.begin(), end, [&](const PartHit& other) { return comes_before(hit, other); });
  if (count == nearest.size()) {
    are_all = false;
    if (at == end) return;
    std::move_backward(at, end - 1, end);
  } else {
    std::move_backward(at, end, end + 1);
    ++count;
  }
  *at = hit;
}

// Instance and triangle fill 64 bits between them, and a bijection keeps apart what is apart.
std::uint64_t triangle_key(std::uint32_t instance, std::uint32_t triangle) {
  return mix((std::uint64_t(instance) << 32U | triangle) + golden);
}

// Keys differ in bits all over before the seed comes in, so that their numbers are independent over seeds; whatever the
// seed, no two keys share their 64 bits.
float coverage_threshold(std::uint32_t seed, std::uint64_t key) {
  return static_cast<float>(mix(key ^ (seed * golden)) >> 40U) * 0x1p-24F;
}

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
  if (coverage >= 1) return;
  const std::uint64_t key =
      shared_key(*args, record, 0).value_or(triangle_key(instance_of(*args, 0), RTCHitN_primID(args->hit, 1, 0)));
  if (context.part_hits != nullptr || context.behind != nullptr) {
    PartHit met{RTCRayN_tfar(args->ray, 1, 0), key, {}, coverage};
    if (context.part_hits != nullptr) {
      args->valid[0] = 0;
      const bool culled = context.embree.filter != nullptr && is_culled(*args, record);
      if (culled || !(coverage > 0)) return;
      met.hit = rtcGetHitFromHitN(args->hit, 1, 0);
      context.part_hits->add(met);
      return;
    }
    if (met.key == context.behind->key || comes_before(met, *context.behind)) {
      args->valid[0] = 0;
      return;
    }
  }
  if (!(coverage > coverage_threshold(context.coverage_seed, key))) args->valid[0] = 0;
}

void filter_back_faces(const RTCFilterFunctionNArguments* args) {
  assert(args->N == 1);
  if (is_culled(*args, *static_cast<const GeometryRecord*>(args->geometryUserPtr))) args->valid[0] = 0;
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
    if (coverage >= 1) {
      context.transmittance = 0;
      continue;
    }
    args->valid[lane] = 0;
    if (coverage <= 0) continue;
    if (const std::optional<std::uint64_t> key = shared_key(*args, record, lane)) {
      auto& passed = context.edges_passed;
      if (std::find(passed.begin(), passed.end(), *key) != passed.end()) continue;
      passed[context.edges_count++ % passed.size()] = *key;
    }
    context.transmittance *= 1 - coverage;
  }
}

}  // namespace ivory
