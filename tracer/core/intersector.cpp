#include "tracer/core/intersector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "grid/base/error.h"
#include "tracer/core/rays/filters.h"
#include "tracer/core/rays/portable_triangles.h"

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

[[noreturn]] void throw_embree(const std::string& scene_name, const std::string& cause) {
  throw Error(scene_name, "Embree cannot build the scene (" + cause + ")", "simplify the scene or free memory");
}

std::vector<V3f> transformed(const std::vector<V3f>& points, const M44f& m) {
  std::vector<V3f> out;
  out.reserve(points.size());
  for (const V3f& p : points) out.push_back(p * m);
  return out;
}

float farthest(const Box3f& box) {
  float most = 0;
  for (int axis = 0; axis < 3; ++axis) most = std::max({most, std::abs(box.min[axis]), std::abs(box.max[axis])});
  return most;
}

}  // namespace

struct Intersector::State {
  const Scene* scene = nullptr;
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  std::vector<RTCScene> mesh_scenes;         // one a mesh that is placed several times, else null
  std::vector<GeometryRecord> records;       // [instance], which is also the top-level geometry id
  std::vector<GeometryRecord> mesh_records;  // [mesh], for geometry inside instances
  std::vector<M33f> normal_to_world;         // [instance]: inverse transpose
  bool has_coverage = false;
  bool portable = false;
  V3f center{0, 0, 0};
  float radius_m = 0;

  ~State() {
    for (RTCScene mesh_scene : mesh_scenes) {
      if (mesh_scene != nullptr) rtcReleaseScene(mesh_scene);
    }
    if (top != nullptr) rtcReleaseScene(top);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  Line line_of(const Ray& ray) const { return portable ? make_line(ray.origin, ray.direction) : Line{}; }

  void check(const char* what) const {
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw_embree(scene->name, what);
  }

  RTCScene new_scene() const {
    RTCScene embree_scene = rtcNewScene(device);
    // The second flag is for filter_back_faces: an Embree that asserts, as Debian's does, aborts without it.
    rtcSetSceneFlags(embree_scene,
                     static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    rtcSetSceneBuildQuality(embree_scene, RTC_BUILD_QUALITY_MEDIUM);
    return embree_scene;
  }

  GeometryRecord record_of(int mesh) const {
    const Material& material = scene->materials[std::size_t(scene->meshes[std::size_t(mesh)].material)];
    return {scene, mesh, ivory::has_coverage(material), !material.double_sided, false, {}, 0};
  }

  // Of the record's mesh, at these places of its vertices.
  RTCGeometry new_geometry(GeometryRecord& record, const std::vector<V3f>& positions, float padding) const {
    if (!portable) {
      RTCGeometry geometry = new_triangles(scene->meshes[std::size_t(record.mesh)], positions);
      set_filters(geometry, record);
      return geometry;
    }
    const auto& triangles = scene->meshes[std::size_t(record.mesh)].triangles;
    record.corners.reserve(triangles.size());
    for (const auto& t : triangles) record.corners.push_back({positions[t.x], positions[t.y], positions[t.z]});
    record.padding = padding;
    return new_portable_triangles(device, record);
  }

  RTCGeometry new_triangles(const Mesh& mesh, const std::vector<V3f>& positions) const {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<V3f*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(V3f), positions.size()));
    auto* indices = static_cast<Imath::Vec3<std::uint32_t>*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                sizeof(Imath::Vec3<std::uint32_t>), mesh.triangles.size()));
    if (vertices == nullptr || indices == nullptr) throw_embree(scene->name, "not enough memory");
    std::copy(positions.begin(), positions.end(), vertices);
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
    return geometry;
  }

  // The most by which a placement of the mesh makes lengths of the world longer in the mesh's own space.
  float shrinking(std::size_t mesh) const {
    float most = 0;
    for (std::size_t i = 0; i < scene->instances.size(); ++i) {
      if (std::size_t(scene->instances[i].mesh) != mesh) continue;
      float squares = 0;
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
          squares += normal_to_world[i][row][column] * normal_to_world[i][row][column];
      }
      most = std::max(most, std::sqrt(squares));
    }
    return most;
  }

  // Filters cost traversal time, so only geometry that can need them has them.
  static void set_filters(RTCGeometry geometry, GeometryRecord& record) {
    rtcSetGeometryUserData(geometry, &record);
    if (!record.has_coverage) return;
    rtcSetGeometryOccludedFilterFunction(geometry, filter_occluded);
    rtcSetGeometryIntersectFilterFunction(geometry, filter_closest);
  }
};

Intersector::Intersector(const Scene& scene, const IntersectorParams& params) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.scene = &scene;
  s.portable = params.portable;
  s.device = rtcNewDevice(nullptr);
  if (s.device == nullptr) throw_embree(scene.name, "no device");
  s.top = s.new_scene();

  std::vector<int> uses(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) ++uses[std::size_t(instance.mesh)];

  // Filters keep pointers to the records: both arrays have their final size before any is taken.
  s.mesh_scenes.assign(scene.meshes.size(), nullptr);
  s.mesh_records.resize(scene.meshes.size());
  s.records.resize(scene.instances.size());
  s.normal_to_world.resize(scene.instances.size());

  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const M44f& to_world = scene.instances[i].to_world;
    const M33f linear(to_world[0][0], to_world[0][1], to_world[0][2], to_world[1][0], to_world[1][1], to_world[1][2],
                      to_world[2][0], to_world[2][1], to_world[2][2]);
    s.normal_to_world[i] = linear.inverse().transposed();
  }

  const Box3f box = bounds(scene);
  // What Embree may be off in a ray's place: a few units in the last place of the largest numbers that it reckons with.
  const float error_m = 0x1p-19F * (box.isEmpty() ? 0 : farthest(box) + box.size().length());

  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const auto m = std::size_t(instance.mesh);
    const Mesh& mesh = scene.meshes[m];
    const M44f& to_world = instance.to_world;
    s.records[i] = s.record_of(instance.mesh);
    s.has_coverage = s.has_coverage || s.records[i].has_coverage;

    RTCGeometry geometry = nullptr;
    if (uses[m] == 1) {
      s.records[i].mirrored_build = to_world.determinant() < 0;
      geometry = s.new_geometry(s.records[i], transformed(mesh.positions, to_world), error_m);
    } else {
      if (s.mesh_scenes[m] == nullptr) {
        s.mesh_records[m] = s.record_of(instance.mesh);
        s.mesh_scenes[m] = s.new_scene();
        RTCGeometry triangles = s.new_geometry(s.mesh_records[m], mesh.positions, error_m * s.shrinking(m));
        rtcCommitGeometry(triangles);
        rtcAttachGeometryByID(s.mesh_scenes[m], triangles, 0);
        rtcReleaseGeometry(triangles);
        rtcCommitScene(s.mesh_scenes[m]);
      }
      geometry = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(geometry, s.mesh_scenes[m]);
      std::array<float, 12> columns{};
      for (std::size_t row = 0; row < 4; ++row) {
        for (std::size_t axis = 0; axis < 3; ++axis)
          columns[3 * row + axis] = to_world[static_cast<int>(row)][static_cast<int>(axis)];
      }
      rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(s.top, geometry, static_cast<unsigned>(i));
    rtcReleaseGeometry(geometry);
  }
  s.check("geometry");
  rtcCommitScene(s.top);
  s.check("hierarchy");

  if (!box.isEmpty()) {
    s.center = box.center();
    // A little larger than the box asks: grids around flat scenes stand out of it.
    s.radius_m = std::max(box.size().length() * 0.505F, 1e-6F);
  }
}

Intersector::~Intersector() = default;
Intersector::Intersector(Intersector&&) noexcept = default;
Intersector& Intersector::operator=(Intersector&&) noexcept = default;

const Scene& Intersector::scene() const { return *state_->scene; }
bool Intersector::portable() const { return state_->portable; }
bool Intersector::has_coverage() const { return state_->has_coverage; }
V3f Intersector::center() const { return state_->center; }
float Intersector::radius_m() const { return state_->radius_m; }

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

std::optional<Hit> Intersector::closest(const Ray& ray) const {
  const Line line = state_->line_of(ray);
  RayContext context = make_context(ray, &line);
  RTCRayHit query = make_query(ray);
  rtcIntersect1(state_->top, &context.embree, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  const bool instanced = query.hit.instID[0] != RTC_INVALID_GEOMETRY_ID;
  Hit hit;
  hit.t = query.ray.tfar;
  hit.barycentric = {query.hit.u, query.hit.v};
  hit.instance = static_cast<int>(instanced ? query.hit.instID[0] : query.hit.geomID);
  hit.triangle = static_cast<int>(query.hit.primID);
  V3f ng(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
  // Embree's normal is that of the winding in the space it was built in; a transform of negative
  // determinant reverses glTF's winding rule, which keeps the front where the inverse transpose puts it.
  if (instanced) {
    ng = ng * state_->normal_to_world[std::size_t(hit.instance)];
  } else if (state_->records[std::size_t(hit.instance)].mirrored_build) {
    ng = -ng;
  }
  hit.ng = ng.normalized();
  return hit;
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
