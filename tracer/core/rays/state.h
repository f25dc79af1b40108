// What an intersector is made of. Private to it.
#pragma once

#include <vector>

#include "tracer/core/intersector.h"
#include "tracer/core/rays/filters.h"

namespace ivory {

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

  State() = default;
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  // Building.
  void check(const char* what) const;
  RTCScene new_scene() const;
  GeometryRecord record_of(int mesh) const;
  // Of the record's mesh, at these places of its vertices.
  RTCGeometry new_geometry(GeometryRecord& record, const std::vector<V3f>& positions, float padding) const;
  RTCGeometry new_triangles(const Mesh& mesh, const std::vector<V3f>& positions) const;
  // The most by which a placement of the mesh makes lengths of the world longer in the mesh's own space.
  float shrinking(std::size_t mesh) const;

  // Asking.
  Line line_of(const Ray& ray) const { return portable ? make_line(ray.origin, ray.direction) : Line{}; }
  std::optional<Hit> closest(const Ray& ray, RayContext& context) const;
  Hit make_hit(float t, const RTCHit& met) const;
};

}  // namespace ivory
