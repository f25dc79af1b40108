// Objects under the mouse: which one a ray meets, and where it goes when the mouse drags it.
#pragma once

#include <optional>

#include "grid/base/types.h"
#include "tracer/core/camera.h"

namespace ivory {

// In what an object moves while it is dragged: parallel to the picture, or level, at the height it was taken by.
enum class DragPlane { view, ground };

struct Drag {
  V3f grabbed_m;         // the point that the mouse took it by
  V3f offset_m;          // where the object was then
  V3f normal;            // of the plane through grabbed_m, unit
  float farthest_m = 1;  // from the eye: rays that meet the plane beyond move nothing
};

// The object stood at `offset_m` when the mouse took it by `grabbed_m`, a point in the world that lies before the
// view's eye. It may go as far as `reach_m` beyond that point's distance.
Drag begin_drag(const View& view, const V3f& grabbed_m, const V3f& offset_m, DragPlane plane, float reach_m);

// Where the object goes with the mouse at `pixel` (as make_ray() counts it): the grabbed point stays under the mouse.
// Empty where the plane is seen edge-on there, lies behind, or too far away: the object then stays.
std::optional<V3f> drag_to(const Drag& drag, const View& view, const V2f& pixel);

}  // namespace ivory
