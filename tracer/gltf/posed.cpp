#include "tracer/gltf/posed.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/anchor.h"
#include "tracer/gltf/accessors.h"
#include "tracer/gltf/pose/animations.h"
#include "tracer/gltf/schema/check.h"
#include "tracer/gltf/stages.h"

namespace ivory {

using nlohmann::json;

struct PosedGltf::State {
  gltf::Document document;
  LoadParams params;
  std::vector<tinygltf::Node> nodes;  // as they are stored
  std::uint64_t hash = 0;
  std::vector<AnimationSpan> animations;
};

namespace {

AnimationSpan read_span(const gltf::Document& document, std::size_t index) {
  const json& source = gltf::element(document, "animations", index);
  AnimationSpan span{source.value("name", std::string()), 0, 0};
  bool any = false;
  for (const json& channel : source["channels"]) {
    const json& target = channel["target"];
    const auto sampler = channel["sampler"].get<std::size_t>();
    if (!target.contains("node") || target["path"] == "pointer" || sampler >= source["samplers"].size()) continue;
    const int input = source["samplers"][sampler]["input"];
    const std::vector<float> times =
        gltf::read_floats(document, input, 1, fmt::format("animations[{}] sampler {} input", index, sampler));
    if (times.empty()) continue;
    span.begin_s = any ? std::min(span.begin_s, double(times.front())) : double(times.front());
    span.end_s = any ? std::max(span.end_s, double(times.back())) : double(times.back());
    any = true;
  }
  return span;
}

// All that the scene places, by other numbers for the same places in the world.
void set_anchor(Scene& scene, const V3d& anchor_m) {
  if (scene.anchor_m == anchor_m) return;
  const V3f by(scene.anchor_m - anchor_m);
  for (Instance& instance : scene.instances) {
    for (unsigned c = 0; c < 3; ++c) instance.to_world[3][c] += by[c];
  }
  for (Camera& camera : scene.cameras) {
    for (unsigned c = 0; c < 3; ++c) camera.to_world[3][c] += by[c];
  }
  for (PunctualLight& light : scene.lights) {
    if (auto* point = std::get_if<PointLight>(&light)) point->position += by;
    if (auto* spot = std::get_if<SpotLight>(&light)) spot->position += by;
  }
  for (SphereLight& light : scene.sphere_lights) light.center += by;
  scene.anchor_m = anchor_m;
}

}  // namespace

PosedGltf::PosedGltf(const std::string& path, const LoadParams& params) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.params = params;
  s.params.time_s.reset();
  s.params.animation.clear();
  gltf::open_document(s.document, path, s.params);
  s.nodes = s.document.model.nodes;
  s.hash = s.document.hash;
  const auto found = s.document.json->find("animations");
  if (found == s.document.json->end() || !found->is_array() || found->empty()) return;
  gltf::check_animation_schema(s.document);
  for (std::size_t i = 0; i < found->size(); ++i) s.animations.push_back(read_span(s.document, i));
}

PosedGltf::~PosedGltf() = default;
PosedGltf::PosedGltf(PosedGltf&&) noexcept = default;
PosedGltf& PosedGltf::operator=(PosedGltf&&) noexcept = default;

const std::vector<AnimationSpan>& PosedGltf::animations() const { return state_->animations; }

Scene PosedGltf::pose(std::size_t animation, double time_s, const V3d& anchor_m) {
  State& s = *state_;
  s.document.model.nodes = s.nodes;
  s.document.hash = s.hash;
  gltf::apply_animation(s.document, std::to_string(animation), time_s);
  Scene scene = std::move(gltf::build_scene(s.document, s.params).scene);
  s.document.warnings.clear();
  s.document.said.clear();
  scene.name = s.document.path;
  scene.content_hash = fmt::format("{:016x}", s.document.hash);
  set_anchor(scene, anchor_m);
  return scene;
}

}  // namespace ivory
