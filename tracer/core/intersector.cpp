#include "tracer/core/intersector.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "grid/base/error.h"
#include "tracer/core/rays/portable_triangles.h"
#include "tracer/core/rays/state.h"

namespace ivory {
namespace {

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

// Filters cost traversal time, so only geometry that can need them has them.
void set_filters(RTCGeometry geometry, GeometryRecord& record) {
  rtcSetGeometryUserData(geometry, &record);
  if (!record.has_coverage) return;
  rtcSetGeometryOccludedFilterFunction(geometry, filter_occluded);
  rtcSetGeometryIntersectFilterFunction(geometry, filter_closest);
}

}  // namespace

Intersector::State::~State() {
  for (RTCScene mesh_scene : mesh_scenes) {
    if (mesh_scene != nullptr) rtcReleaseScene(mesh_scene);
  }
  if (top != nullptr) rtcReleaseScene(top);
  if (device != nullptr) rtcReleaseDevice(device);
}

void Intersector::State::check(const char* what) const {
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw_embree(scene->name, what);
}

RTCScene Intersector::State::new_scene() const {
  RTCScene embree_scene = rtcNewScene(device);
  // The second flag is for filter_back_faces: an Embree that asserts, as Debian's does, aborts without it.
  rtcSetSceneFlags(embree_scene,
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  rtcSetSceneBuildQuality(embree_scene, RTC_BUILD_QUALITY_MEDIUM);
  return embree_scene;
}

GeometryRecord Intersector::State::record_of(int mesh) const {
  const Material& material = scene->materials[std::size_t(scene->meshes[std::size_t(mesh)].material)];
  return {scene, mesh, ivory::has_coverage(material), !material.double_sided, false, {}, 0};
}

RTCGeometry Intersector::State::new_geometry(GeometryRecord& record, const std::vector<V3f>& positions,
                                             float padding) const {
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

RTCGeometry Intersector::State::new_triangles(const Mesh& mesh, const std::vector<V3f>& positions) const {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<V3f*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(V3f), positions.size()));
  auto* indices = static_cast<Imath::Vec3<std::uint32_t>*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Imath::Vec3<std::uint32_t>), mesh.triangles.size()));
  if (vertices == nullptr || indices == nullptr) throw_embree(scene->name, "not enough memory");
  std::copy(positions.begin(), positions.end(), vertices);
  std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
  return geometry;
}

float Intersector::State::shrinking(std::size_t mesh) const {
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

}  // namespace ivory
