#include "tools/view/world/drag.h"

#include <cmath>

namespace ivory {

Drag begin_drag(const View& view, const V3f& grabbed_m, const V3f& offset_m, DragPlane plane, float reach_m) {
  Drag drag;
  drag.grabbed_m = grabbed_m;
  drag.offset_m = offset_m;
  drag.normal = plane == DragPlane::view ? view.forward : V3f(0, 1, 0);
  drag.farthest_m = (grabbed_m - view.origin).length() + reach_m;
  return drag;
}

std::optional<V3f> drag_to(const Drag& drag, const View& view, const V2f& pixel) {
  const Ray ray = make_ray(view, pixel);
  const float cosine = ray.direction.dot(drag.normal);
  constexpr float edge_on = 1e-3F;  // a pixel would be metres
  if (std::abs(cosine) < edge_on) return std::nullopt;
  const float t = (drag.grabbed_m - ray.origin).dot(drag.normal) / cosine;
  const V3f at = ray.origin + ray.direction * t;
  if (!(t > 0) || (at - view.origin).length() > drag.farthest_m) return std::nullopt;
  return drag.offset_m + (at - drag.grabbed_m);
}

}  // namespace ivory
