#include "tools/view/session/animation.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/cli/numbers.h"
#include "tools/input/objects.h"
#include "tools/view/session/lamps.h"
#include "tools/view/session/occluders.h"
#include "tools/view/session/session.h"

namespace ivory {

namespace {

// By name or index, as --animation takes it.
std::size_t find_animation(const std::vector<AnimationSpan>& all, const std::string& text) {
  const auto named = std::find_if(all.begin(), all.end(), [&](const AnimationSpan& a) { return a.name == text; });
  if (!text.empty() && named != all.end()) return std::size_t(named - all.begin());
  const std::optional<double> index = parse_number(text);
  return index && *index >= 0 && *index < double(all.size()) ? std::size_t(*index) : 0;
}

// The object in that pose, on the GPU too.
void show(ViewObject& object, Scene pose) {
  Scene& before = *object.scene;
  pose.images = std::move(before.images);
  pose.content_hash = before.content_hash;  // it is that scene still, to assets that were baked from it
  try {
    update(object.model, before, pose);
  } catch (...) {
    before.images = std::move(pose.images);
    throw;
  }
  set_scene(object, std::move(pose));
}

// Null where the file has no animation.
std::unique_ptr<SceneAnimation> open_animation(const std::string& path, const SceneOptions& load) {
  PosedGltf file(path, load.load);
  if (file.animations().empty()) return nullptr;
  auto animation = std::make_unique<SceneAnimation>(SceneAnimation{std::move(file), {}, {}});
  animation->chosen = find_animation(animation->file.animations(), load.load.animation);
  animation->posed = load.load.time_s.has_value();
  animation->time_s = load.load.time_s.value_or(0);
  animation->shown_s = animation->time_s;
  animation->shown = animation->chosen;
  return animation;
}

}  // namespace

void prepare_animation(ViewSession& session, const SessionInput& input, const std::vector<ViewObject>& objects) {
  if (!input.plays && !input.may_play) return;
  try {
    session.animation = open_animation(input.scene, input.load);
  } catch (const Error& error) {
    if (input.plays) throw;
    session.notes.push_back(fmt::format("note: no animation plays: {}", error.what()));
  }
  if (!session.animation) {
    if (input.plays) throw UsageError("--play: " + input.scene + " has no animation");
    return;
  }
  session.animation->sphere_lights = input.sphere_lights;
  for (const ViewObject& object : objects) {
    if (!object.node.empty()) session.animation->objects.push_back(object.node);
  }
}

void pose_scene(ViewSession& session) {
  if (!session.animation) return;
  SceneAnimation& animation = *session.animation;
  if (animation.posed && animation.shown_s == animation.time_s && animation.shown == animation.chosen) return;
  ViewWorld& world = session.world;
  Scene scene = animation.file.pose(animation.chosen, animation.time_s, world.scene().anchor_m);
  std::vector<std::pair<ViewObject*, Scene>> objects;
  for (const std::string& name : animation.objects) {
    const V3f pivot = pivot_of_node(scene, name);
    Scene taken = take_node(scene, name);
    const auto object =
        std::find_if(world.objects.begin(), world.objects.end(), [&](const ViewObject& o) { return o.node == name; });
    if (object == world.objects.end()) continue;  // it was removed
    object->pivot_m = pivot;
    objects.emplace_back(&*object, std::move(taken));
  }
  for (const SphereLightOption& light : animation.sphere_lights) add_sphere_light(scene, light, "--sphere-light");
  objects.emplace_back(&world.objects.front(), std::move(scene));
  for (auto& [object, pose] : objects) {
    if (!pose.instances.empty()) show(*object, std::move(pose));
  }
  animation.posed = true;
  animation.shown_s = animation.time_s;
  animation.shown = animation.chosen;
  find_occluders_again(session.assets, world);
  session.lobes_placed.clear();  // spherical lights may be elsewhere
  shine(session);
  find_extended_lights(session);
}

}  // namespace ivory
