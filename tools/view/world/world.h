// What the viewer shows: the scene, objects that move, and where the camera stands.
#pragma once

#include <optional>
#include <vector>

#include "tools/view/world/camera.h"
#include "tools/view/world/object.h"

namespace ivory {

struct ViewWorld {
  std::vector<ViewObject> objects;  // the first is the scene itself
  ViewCamera camera;
  V3f center_m{0, 0, 0};  // of the sphere around the scene and its objects, before paths move them
  float radius_m = 1;
  double time_s = 0;

  const Scene& scene() const { return *objects.front().scene; }
};

// Sets the sphere. To be called when objects were added: depth and steps of the camera go by it.
void measure(ViewWorld& world);

// The object that a ray meets first, and where in the world; nothing where it meets none.
struct Pick {
  std::size_t object = 0;
  V3f point_m{0, 0, 0};
};
std::optional<Pick> pick(const ViewWorld& world, const Ray& ray);

}  // namespace ivory
