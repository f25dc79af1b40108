#include "tools/view/world/object.h"

#include <algorithm>
#include <utility>

#include "grid/base/anchor.h"
#include "grid/base/error.h"

namespace ivory {

Placement place(const ViewObject& object, double time_s) {
  const PathPoint on_path = at(object.path, time_s);
  return {object.offset_m + on_path.offset_m, object.turn_deg + on_path.turn_deg, object.scale * on_path.scale,
          object.pivot_m};
}

V3d offset_in_world(const ViewObject& object, const V3f& offset_m, const V3d& anchor_m) {
  return V3d(offset_m) + (anchor_m - object.scene->anchor_m);
}

V3f offset_in_scene(const ViewObject& object, const V3d& offset_m, const V3d& anchor_m) {
  return to_local(object.scene->anchor_m + offset_m, anchor_m);
}

ViewObject make_object(std::string name, Scene scene, const V3f& offset_m, bool moves) {
  ViewObject object;
  object.name = std::move(name);
  set_scene(object, std::move(scene));
  object.offset_m = offset_m;
  object.moves = moves;
  return object;
}

const Intersector& traced(const ViewObject& object) {
  if (!object.intersector) object.intersector = std::make_unique<Intersector>(*object.scene);
  return *object.intersector;
}

void set_scene(ViewObject& object, Scene scene) {
  if (scene.instances.empty()) throw Error(scene.name, "has no triangles", "give a model with a mesh");
  object.intersector.reset();  // of the scene so far
  object.scene = std::make_unique<Scene>(std::move(scene));
  const Box3f box = bounds(*object.scene);
  object.center_m = box.center();
  object.radius_m = std::max(0.505F * box.size().length(), 1e-6F);
}

}  // namespace ivory
