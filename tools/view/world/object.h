// What moves as one: the scene itself, or an object in it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "grid/base/placement.h"
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
  std::string node;  // of the world's scene that it was taken from; empty: a file
  std::unique_ptr<Scene> scene;
  mutable std::unique_ptr<Intersector> intersector;  // of that scene, where it is local: traced()
  V3f center_m{0, 0, 0};                             // of a sphere around it, local
  float radius_m = 1;
  GpuModel model;                                  // of that scene; empty until it is uploaded
  V3f offset_m{0, 0, 0};                           // of its local positions to those of the world's scene
  V3f turn_deg{0, 0, 0};                           // as Placement has it
  float scale = 1;                                 // of all lengths
  V3f pivot_m{0, 0, 0};                            // local: what turning and scaling leave where it is
  ObjectPath path;                                 // on top of the three
  bool moves = true;                               // false: the scene itself
  std::vector<ObjectLight> lights{ObjectLight{}};  // never empty
  std::optional<GpuFivOccluder> occluder;          // that it is for others, local
  bool occludes = true;                            // false: turned as its tables cannot be (session/occluders.h)
};

// From its local positions to those of the world's scene at that time.
Placement place(const ViewObject& object, double time_s);
// Such an offset as one from where the object's file has it, in the world of a scene of that anchor; and back.
V3d offset_in_world(const ViewObject& object, const V3f& offset_m, const V3d& anchor_m);
V3f offset_in_scene(const ViewObject& object, const V3d& offset_m, const V3d& anchor_m);

// `offset_m` as the object keeps it. Makes no model: that needs OpenGL. Throws Error where the scene has no triangles.
ViewObject make_object(std::string name, Scene scene, const V3f& offset_m, bool moves);

// Its scene for rays, built when first asked for after set_scene(). Throws as Intersector does.
const Intersector& traced(const ViewObject& object);

// Another pose, whose model is to be brought up to date by who has a context. Throws Error, and changes nothing, where
// the scene has no triangles.
void set_scene(ViewObject& object, Scene scene);

}  // namespace ivory
