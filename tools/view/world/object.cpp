#include "tools/view/world/object.h"

#include <utility>

#include "grid/base/anchor.h"
#include "grid/base/error.h"

namespace ivory {

V3f place(const ViewObject& object, double time_s) { return object.offset_m + offset_at(object.path, time_s); }

V3d offset_in_world(const ViewObject& object, const V3f& offset_m, const V3d& anchor_m) {
  return V3d(offset_m) + (anchor_m - object.scene->anchor_m);
}

V3f offset_in_scene(const ViewObject& object, const V3d& offset_m, const V3d& anchor_m) {
  return to_local(object.scene->anchor_m + offset_m, anchor_m);
}

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

}  // namespace ivory
