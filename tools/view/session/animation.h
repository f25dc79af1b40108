// The scene's own animations: nodes, skins and morphs as they stand at a time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/cli/common.h"
#include "tools/input/scene.h"
#include "tracer/gltf/posed.h"

namespace ivory {

struct SessionInput;
struct ViewObject;
struct ViewSession;

struct SceneAnimation {
  PosedGltf file;
  std::vector<std::string> objects;              // nodes that were taken out of the scene, in that order
  std::vector<SphereLightOption> sphere_lights;  // added to it
  std::size_t chosen = 0;
  double time_s = 0;   // that the user asks for
  bool posed = false;  // is the scene as the animation has it at shown_s, or as it is stored?
  double shown_s = 0;
  std::size_t shown = 0;  // animation

  const AnimationSpan& span() const { return file.animations()[chosen]; }
};

// Opens the scene's file for playing, where `input` says that it plays or may, as it was loaded and with `objects`
// taken out of it. Throws UsageError where it is to play and has no animation; Error as PosedGltf does, which is a note
// where it only may.
void prepare_animation(ViewSession& session, const SessionInput& input, const std::vector<ViewObject>& objects);

// Poses the scene, the objects that are nodes of it, lamps, occluders and lights with extent by session.animation at
// its time, by the code of ivory render --time; nothing where they stand so already or there is none. Needs a current
// context. Throws Error as load_gltf() and upload() do, and then leaves all as it was.
void pose_scene(ViewSession& session);

}  // namespace ivory
