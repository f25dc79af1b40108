#include "tools/view/world/world.h"

#include <algorithm>

namespace ivory {

void measure(ViewWorld& world) {
  // The sphere that an Intersector of all of them together would have, so that a framing view is that of ivory render.
  Box3f box;
  for (const ViewObject& object : world.objects) {
    const Box3f own = bounds(*object.scene);
    box.extendBy(own.min + object.offset_m);
    box.extendBy(own.max + object.offset_m);
  }
  world.center_m = box.center();
  world.radius_m = std::max(box.size().length() * 0.505F, 1e-6F);
}

std::optional<Pick> pick(const ViewWorld& world, const Ray& ray) {
  std::optional<Pick> nearest;
  Ray search = ray;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const ViewObject& object = world.objects[i];
    const V3f at = place(object, world.time_s);
    search.origin = ray.origin - at;
    const std::optional<Hit> hit = object.intersector->closest(search);
    if (!hit) continue;
    search.t_max = hit->t;
    nearest = Pick{i, ray.origin + ray.direction * hit->t};
  }
  return nearest;
}

}  // namespace ivory
