// What moves as one: the scene itself, or an object in it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/assets/fiv.h"
#include "tools/view/session/settings.h"
#include "tools/view/world/model.h"
#include "tools/view/world/path.h"
#include "tracer/core/intersector.h"
#include "tracer/core/scene.h"

namespace ivory {

struct ViewAsset;

// What an object is lit by: one of the sources that add up.
struct ObjectLight {
  ViewMethod method = ViewMethod::none;
  const ViewAsset* asset = nullptr;  // that the method reads; null where it reads none
  float weight = 1;                  // factor on its light
};

struct ViewObject {
  std::string name;  // file without folders, or node
  std::unique_ptr<Scene> scene;
  std::unique_ptr<Intersector> intersector;        // of that scene, where it is local
  GpuModel model;                                  // of that scene; empty until it is uploaded
  V3f offset_m{0, 0, 0};                           // of its local positions to those of the world's scene
  ObjectPath path;                                 // on top of the offset
  bool moves = true;                               // false: the scene itself
  std::vector<ObjectLight> lights{ObjectLight{}};  // never empty
  std::optional<GpuFivOccluder> occluder;          // that it is for others, local
};

// What to add to its local positions for those of the world's scene at that time; m.
V3f place(const ViewObject& object, double time_s);
// Such an offset as one from where the object's file has it, in the world of a scene of that anchor; and back.
V3d offset_in_world(const ViewObject& object, const V3f& offset_m, const V3d& anchor_m);
V3f offset_in_scene(const ViewObject& object, const V3d& offset_m, const V3d& anchor_m);

// `offset_m` as the object keeps it. Builds Embree's structures, but no model: that needs OpenGL. Throws Error where
// the scene has no triangles.
ViewObject make_object(std::string name, Scene scene, const V3f& offset_m, bool moves);

}  // namespace ivory
