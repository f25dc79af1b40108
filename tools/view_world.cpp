#include "tools/view_world.h"

#include <utility>

#include "grid/error.h"

namespace ivory {

V3f place(const ViewObject& object, double time_s) { return object.offset_m + offset_at(object.path, time_s); }

ViewObject make_object(std::string name, Scene scene, const V3f& offset_m, bool moves) {
  if (scene.instances.empty()) throw Error(scene.name, "has no triangles", "give a model with a mesh");
  ViewObject object;
  object.name = std::move(name);
  object.scene = std::make_unique<Scene>(std::move(scene));
  object.intersector = std::make_unique<Intersector>(*object.scene);
  object.offset_m = offset_m;
  object.moves = moves;
  return object;
}

void measure(ViewWorld& world) {
  Box3f box;
  for (const ViewObject& object : world.objects) {
    const V3f center = object.intersector->center() + object.offset_m;
    const float r = object.intersector->radius_m();
    box.extendBy(center - V3f(r, r, r));
    box.extendBy(center + V3f(r, r, r));
  }
  world.center_m = box.center();
  world.radius_m = 0;
  for (const ViewObject& object : world.objects) {
    const V3f center = object.intersector->center() + object.offset_m;
    world.radius_m = std::max(world.radius_m, (center - world.center_m).length() + object.intersector->radius_m());
  }
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
