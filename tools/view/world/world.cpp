#include "tools/view/world/world.h"

#include <algorithm>

namespace ivory {

void measure(ViewWorld& world) {
  // The sphere that an Intersector of all of them together would have, so that a framing view is that of ivory render.
  Box3f box;
  for (const ViewObject& object : world.objects) {
    const Box3f own = bounds(*object.scene);
    const Placement placement{object.offset_m, object.turn_deg, object.scale, object.pivot_m};
    for (int corner = 0; corner < 8; ++corner) {
      box.extendBy(
          placed(placement, V3f((corner & 1) != 0 ? own.max.x : own.min.x, (corner & 2) != 0 ? own.max.y : own.min.y,
                                (corner & 4) != 0 ? own.max.z : own.min.z)));
    }
  }
  world.center_m = box.center();
  world.radius_m = std::max(box.size().length() * 0.505F, 1e-6F);
}

std::optional<Pick> pick(const ViewWorld& world, const Ray& ray) {
  std::optional<Pick> nearest;
  Ray search = ray;
  float nearest_t = ray.t_max;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const ViewObject& object = world.objects[i];
    // Into the object's own space and size; directions stay of unit length.
    const Placement at = place(object, world.time_s);
    search.origin = unplaced(at, ray.origin);
    search.direction = ray.direction * turn_of(at).transposed();
    search.t_max = nearest_t / at.scale;
    const std::optional<Hit> hit = traced(object).closest(search);
    if (!hit) continue;
    nearest_t = hit->t * at.scale;
    nearest = Pick{i, ray.origin + ray.direction * nearest_t};
  }
  return nearest;
}

}  // namespace ivory
