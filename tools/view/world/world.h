// What the viewer shows, apart from how it is drawn: the scene, objects that move, and where the camera stands.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/view/world/camera.h"
#include "tools/view/world/path.h"
#include "tracer/core/intersector.h"
#include "tracer/core/scene.h"

namespace ivory {

// The scene itself, or an object in it: whatever moves as one.
struct ViewObject {
  std::string name;  // file without folders, or node
  std::unique_ptr<Scene> scene;
  std::unique_ptr<Intersector> intersector;  // of that scene, where the file has it
  V3f offset_m{0, 0, 0};                     // from there
  ObjectPath path;                           // on top of the offset
  bool moves = true;                         // false: the scene itself
};

// Where the object is, relative to where its file has it.
V3f place(const ViewObject& object, double time_s);

struct ViewWorld {
  std::vector<ViewObject> objects;  // the first is the scene itself
  ViewCamera camera;
  V3f center_m{0, 0, 0};  // sphere around the scene and its objects at their own places
  float radius_m = 1;
  double time_s = 0;

  const Scene& scene() const { return *objects.front().scene; }
};

// Embree's structures and all; throws Error where the model has no triangles.
ViewObject make_object(std::string name, Scene scene, const V3f& offset_m, bool moves);

// To be called when objects were added: depth and steps of the camera go by the sphere.
void measure(ViewWorld& world);

// The object that a ray meets first, and where.
struct Pick {
  std::size_t object = 0;
  V3f point_m{0, 0, 0};
};
std::optional<Pick> pick(const ViewWorld& world, const Ray& ray);

}  // namespace ivory
