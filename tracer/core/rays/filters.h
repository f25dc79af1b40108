// What Embree asks about each surface that a ray meets: coverage and culled back faces. Private to the intersector.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <embree3/rtcore.h>

#include "tracer/core/rays/crossing.h"
#include "tracer/core/scene.h"

namespace ivory {

// What the filters need to know of an Embree geometry.
struct GeometryRecord {
  const Scene* scene = nullptr;
  int mesh = no_index;
  bool has_coverage = false;
  bool single_sided = false;
  bool mirrored_build = false;  // built in world space by a mirroring transform: its winding is reversed
  // Of portable triangles alone: corners in the space that they are built in, and how far a ray there may be off.
  std::vector<std::array<V3f, 3>> corners;
  float padding = 0;
};

// A surface of part coverage as Embree met it, and what tells it from all others.
struct PartHit {
  float t;
  std::uint64_t key;
  RTCHit hit;
  float coverage;
};
// The nearest surfaces of part coverage that a ray met, in order of (t, key).
struct PartHits {
  std::array<PartHit, 8> nearest;
  std::size_t count = 0;
  bool are_all = true;

  void add(const PartHit& hit);
};

// Embree hands this context to the filters, which decide what a ray meets.
struct RayContext {
  RTCIntersectContext embree;  // must be first: the filters cast back to RayContext
  std::uint32_t coverage_seed = 0;
  float transmittance = 1;
  // The last edges between triangles that the ray passed through exactly: it meets both triangles, and one surface.
  std::array<std::uint64_t, 8> edges_passed{};
  std::size_t edges_count = 0;
  float blocking_coverage = -1;     // visibility queries: coverage of at least this blocks whole
  PartHits* part_hits = nullptr;    // closest hits alone: collects surfaces of part coverage, which the ray passes
  const PartHit* behind = nullptr;  // surfaces of part coverage up to this one are not there
  const Line* lines = nullptr;      // the rays in the world, each by its id, for portable triangles
};

// 64 bits that no two triangles of a scene share, however instances and triangles are numbered.
std::uint64_t triangle_key(std::uint32_t instance, std::uint32_t triangle);

// Uniform in [0,1), for a ray of that coverage seed at a surface of that key: the surface is there where the number
// lies below its coverage. A ray may ask several times about one surface and gets one answer; over seeds, the numbers
// of different surfaces are independent.
float coverage_threshold(std::uint32_t seed, std::uint64_t key);

// Closest hits on geometry that has coverage: a partly covered surface may be missed.
void filter_closest(const RTCFilterFunctionNArguments* args);
// Closest hits of the eye's rays: back faces of single-sided materials are not there.
void filter_back_faces(const RTCFilterFunctionNArguments* args);
// Any hits: partly covered surfaces dim the ray and let it go on.
void filter_occluded(const RTCFilterFunctionNArguments* args);

}  // namespace ivory
