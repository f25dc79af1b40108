#include "tracer/core/rays/portable_triangles.h"

#include <limits>
#include <optional>
#include <utility>

#include "tracer/core/rays/crossing.h"

namespace ivory {
namespace {

using Corners = std::array<V3f, 3>;

void find_bounds(const RTCBoundsFunctionArguments* args) {
  const auto& record = *static_cast<const GeometryRecord*>(args->geometryUserPtr);
  Box3f box;
  for (const V3f& corner : record.corners[args->primID]) box.extendBy(corner);
  RTCBounds& out = *args->bounds_o;
  out.lower_x = box.min.x - record.padding;
  out.lower_y = box.min.y - record.padding;
  out.lower_z = box.min.z - record.padding;
  out.upper_x = box.max.x + record.padding;
  out.upper_y = box.max.y + record.padding;
  out.upper_z = box.max.z + record.padding;
}

// What a lane's ray and a triangle are to each other.
struct Meeting {
  const GeometryRecord& record;
  RayContext& context;
  unsigned geometry;
  unsigned triangle;
  unsigned instance() const {
    const unsigned placed = context.embree.instID[0];
    return placed != RTC_INVALID_GEOMETRY_ID ? placed : geometry;
  }

  // In the world, by the ray as it was asked for: inside an instance Embree hands on its own rounding of it.
  std::optional<Crossing> cross(unsigned ray) const {
    if (context.embree.instID[0] == RTC_INVALID_GEOMETRY_ID)
      return crossing(context.lines[ray], record.corners[triangle]);
    Corners corners = record.corners[triangle];
    const M44f& to_world = record.scene->instances[instance()].to_world;
    for (V3f& corner : corners) corner = corner * to_world;
    return crossing(context.lines[ray], corners);
  }

  RTCRayHit hit(const RTCRayN* rays, unsigned lanes, unsigned lane, const Crossing& met) const {
    RTCRayHit out{};
    out.ray.dir_x = RTCRayN_dir_x(const_cast<RTCRayN*>(rays), lanes, lane);
    out.ray.dir_y = RTCRayN_dir_y(const_cast<RTCRayN*>(rays), lanes, lane);
    out.ray.dir_z = RTCRayN_dir_z(const_cast<RTCRayN*>(rays), lanes, lane);
    out.ray.tfar = float(met.t);
    out.hit.u = float(met.u);
    out.hit.v = float(met.v);
    const Corners& corners = record.corners[triangle];
    const V3f ng = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    out.hit.Ng_x = ng.x;
    out.hit.Ng_y = ng.y;
    out.hit.Ng_z = ng.z;
    out.hit.primID = triangle;
    out.hit.geomID = geometry;
    out.hit.instID[0] = context.embree.instID[0];
    return out;
  }

  // Is the surface there for this ray?
  bool stands(RTCRayHit& hit, RTCFilterFunctionN by_coverage) const {
    int valid = -1;
    const RTCFilterFunctionNArguments args{&valid,
                                           const_cast<GeometryRecord*>(&record),
                                           &context.embree,
                                           reinterpret_cast<RTCRayN*>(&hit.ray),
                                           reinterpret_cast<RTCHitN*>(&hit.hit),
                                           1};
    if (record.has_coverage) by_coverage(&args);
    if (valid != 0 && context.embree.filter != nullptr) context.embree.filter(&args);
    return valid != 0;
  }
};

template <typename Arguments>
Meeting meeting(const Arguments& args) {
  return {*static_cast<const GeometryRecord*>(args.geometryUserPtr), *reinterpret_cast<RayContext*>(args.context),
          args.geomID, args.primID};
}

void intersect(const RTCIntersectFunctionNArguments* args) {
  const Meeting at = meeting(*args);
  const unsigned lanes = args->N;
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, lanes);
  RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, lanes);
  for (unsigned lane = 0; lane < lanes; ++lane) {
    if (args->valid[lane] == 0) continue;
    const std::optional<Crossing> met = at.cross(RTCRayN_id(rays, lanes, lane));
    if (!met) continue;
    float& t_far = RTCRayN_tfar(rays, lanes, lane);
    if (!(float(met->t) >= RTCRayN_tnear(rays, lanes, lane) && float(met->t) <= t_far)) continue;
    RTCRayHit hit = at.hit(rays, lanes, lane, *met);
    // Of surfaces at one place the first by number, in whatever order they are found.
    if (hit.ray.tfar == t_far && RTCHitN_geomID(hits, lanes, lane) != RTC_INVALID_GEOMETRY_ID) {
      const unsigned placed = RTCHitN_instID(hits, lanes, lane, 0);
      const unsigned instance = placed != RTC_INVALID_GEOMETRY_ID ? placed : RTCHitN_geomID(hits, lanes, lane);
      if (std::pair(at.instance(), at.triangle) > std::pair(instance, RTCHitN_primID(hits, lanes, lane))) continue;
    }
    if (!at.stands(hit, filter_closest)) continue;
    t_far = hit.ray.tfar;
    rtcCopyHitToHitN(hits, &hit.hit, lanes, lane);
  }
}

void occlude(const RTCOccludedFunctionNArguments* args) {
  const Meeting at = meeting(*args);
  const unsigned lanes = args->N;
  for (unsigned lane = 0; lane < lanes; ++lane) {
    if (args->valid[lane] == 0) continue;
    const std::optional<Crossing> met = at.cross(RTCRayN_id(args->ray, lanes, lane));
    if (!met) continue;
    float& t_far = RTCRayN_tfar(args->ray, lanes, lane);
    if (!(float(met->t) >= RTCRayN_tnear(args->ray, lanes, lane) && float(met->t) <= t_far)) continue;
    RTCRayHit hit = at.hit(args->ray, lanes, lane, *met);
    if (at.stands(hit, filter_occluded)) t_far = -std::numeric_limits<float>::infinity();
  }
}

}  // namespace

RTCGeometry new_portable_triangles(RTCDevice device, const GeometryRecord& record) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, unsigned(record.corners.size()));
  rtcSetGeometryUserData(geometry, const_cast<GeometryRecord*>(&record));
  rtcSetGeometryBoundsFunction(geometry, find_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect);
  rtcSetGeometryOccludedFunction(geometry, occlude);
  return geometry;
}

}  // namespace ivory
