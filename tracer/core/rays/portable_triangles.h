// Triangles that Embree only finds the way to, and that crossing() meets: the same hits on every CPU. Private to the
// intersector.
#pragma once

#include "tracer/core/rays/filters.h"

namespace ivory {

// A geometry of record.corners, not yet committed; `record` must stay where it is. Asks
// its filters itself. The caller releases it.
RTCGeometry new_portable_triangles(RTCDevice device, const GeometryRecord& record);

}  // namespace ivory
