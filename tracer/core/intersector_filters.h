// What Embree asks about each surface that a ray meets: coverage and culled back faces. Private to the intersector.
#pragma once

#include <cstdint>

#include <embree3/rtcore.h>

#include "tracer/core/scene.h"

namespace ivory {

// What the filters need to know of an Embree geometry.
struct GeometryRecord {
  const Scene* scene = nullptr;
  int mesh = no_index;
  bool has_coverage = false;
  bool single_sided = false;
  bool mirrored_build = false;  // built in world space by a mirroring transform: its winding is reversed
};

// Embree hands this context to the filters, which decide what a ray meets.
struct RayContext {
  RTCIntersectContext embree;  // must be first: the filters cast back to RayContext
  std::uint32_t coverage_seed = 0;
  float transmittance = 1;
  float blocking_coverage = -1;  // visibility queries: coverage of at least this blocks whole
};

// Closest hits on geometry that has coverage: a partly covered surface may be missed.
void filter_closest(const RTCFilterFunctionNArguments* args);
// Closest hits of the eye's rays: back faces of single-sided materials are not there.
void filter_back_faces(const RTCFilterFunctionNArguments* args);
// Any hits: partly covered surfaces dim the ray and let it go on.
void filter_occluded(const RTCFilterFunctionNArguments* args);

}  // namespace ivory
