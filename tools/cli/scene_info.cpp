#include "tools/cli/scene_info.h"

#include <algorithm>
#include <variant>

#include <nlohmann/json.hpp>

#include "tools/input/hints.h"
#include "tracer/core/camera.h"
#include "tracer/lights/punctual.h"

namespace ivory {

namespace {

Json rgb_json(const Rgb& c) { return {shortest(c.x), shortest(c.y), shortest(c.z)}; }

Json light_json(const PunctualLight& light, const V3d& anchor_m) {
  if (const auto* sun = std::get_if<DirectionalLight>(&light))
    return {{"type", "directional"}, {"illuminance_lux", rgb_json(sun->illuminance_lux)}};
  const auto* spot = std::get_if<SpotLight>(&light);
  const auto* point = std::get_if<PointLight>(&light);
  return {{"type", spot != nullptr ? "spot" : "point"},
          {"intensity_cd", rgb_json(spot != nullptr ? spot->intensity_cd : point->intensity_cd)},
          {"power_lm", rgb_json(power_lm(light, 0))},
          {"position_m", shortest(spot != nullptr ? spot->position : point->position, anchor_m)}};
}

}  // namespace

Json scene_info(const std::string& path, const SceneOptions& options, const CommonOptions& common) {
  // The warnings are part of the result here.
  CommonOptions silent = common;
  silent.quiet = true;
  const auto input = load_scene_input(path, options, {}, silent);
  const Scene& scene = *input.lit.scene;
  std::size_t triangles = 0;
  std::size_t placed = 0;
  for (const Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
  for (const Instance& instance : scene.instances) placed += scene.meshes[std::size_t(instance.mesh)].triangles.size();
  const auto emissive = std::count_if(scene.materials.begin(), scene.materials.end(),
                                      [](const Material& material) { return !is_black(material.emission); });
  std::size_t points = 0;
  std::size_t spots = 0;
  std::size_t suns = 0;
  Json lights = Json::array();
  for (const PunctualLight& light : scene.lights) {
    points += std::holds_alternative<PointLight>(light) ? 1 : 0;
    spots += std::holds_alternative<SpotLight>(light) ? 1 : 0;
    suns += std::holds_alternative<DirectionalLight>(light) ? 1 : 0;
    lights.push_back(light_json(light, scene.anchor_m));
  }
  Json json{{"kind", "scene"},
            {"content_hash", scene.content_hash},
            {"triangles", triangles},
            {"triangles_placed", placed},
            {"meshes", scene.meshes.size()},
            {"instances", scene.instances.size()},
            {"materials", scene.materials.size()},
            {"emissive_materials", emissive},
            {"images", scene.images.size()},
            {"cameras", scene.cameras.size()},
            {"point_lights", points},
            {"spot_lights", spots},
            {"directional_lights", suns},
            {"spherical_lights", scene.sphere_lights.size()}};
  if (const Box3f box = bounds(scene); !box.isEmpty()) {
    json["bounds_min_m"] = shortest(box.min, scene.anchor_m);
    json["bounds_max_m"] = shortest(box.max, scene.anchor_m);
  }
  json["power_lm"] = rgb_json(input.lit.lights.total_power_lm());
  json["lights"] = std::move(lights);
  std::vector<std::string> warnings = input.warnings;
  for (const Camera& camera : scene.cameras) {
    if (const auto doubt = doubt_about(input.lit.intersector, make_view(path, camera, 4, 3), camera.name))
      warnings.push_back(*doubt);
  }
  json["warnings"] = warnings;
  json["hints"] = hints(input.lit);
  return json;
}

}  // namespace ivory
