#include "tracer/gltf/nodes/lights.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tracer/gltf/nodes/tree.h"

namespace ivory::gltf {
namespace {

using nlohmann::json;

// What exporters write beside the specification is mended: Blender has equal angles for a hard edge. False where the
// cone has no width.
bool read_cone(Document& document, const json& source, const std::string& what, SpotLight& spot) {
  constexpr double right_angle = 1.5707963267948966;
  double outer = source.value("outerConeAngle", 0.25 * double(pi));
  double inner = source.value("innerConeAngle", 0.0);
  if (!(outer >= 1e-6)) {
    document.warn(what + " has a cone without width: it lights nothing and is left out");
    return false;
  }
  if (outer > right_angle * (1 + 1e-6)) {
    document.warn(fmt::format("{} has an outer cone of {} rad; pi / 2, the most there is, is taken", what, outer));
  }
  outer = std::min(outer, right_angle);
  if (inner >= outer) {
    document.warn(fmt::format("{} has an inner cone {} its outer one: its edge is taken as hard, at {} rad", what,
                              inner == outer ? "equal to" : "wider than", outer));
  }
  spot.outer_angle_rad = float(outer);
  spot.inner_angle_rad = std::min(float(inner), spot.outer_angle_rad);
  return true;
}

}  // namespace

std::optional<PunctualLight> read_light(Document& document, std::size_t index, std::size_t node,
                                        const Imath::M44d& to_scene) {
  const json& light = (*find_extension(*document.json, "KHR_lights_punctual"))["lights"][index];
  const std::string what = label("lights", index, light.value("name", std::string()));
  const std::string type = light["type"];
  const float intensity = light.value("intensity", 1.0F);
  Rgb strength(intensity);
  if (light.contains("color")) {
    const json& color = light["color"];
    strength = Rgb(color[0], color[1], color[2]) * intensity;
  }
  if (light.contains("range")) document.warn(what + " has a range, which is ignored: light falls off with the square");
  const V3f position{V3d(to_scene[3][0], to_scene[3][1], to_scene[3][2])};
  const V3d axis(-to_scene[2][0], -to_scene[2][1], -to_scene[2][2]);
  const V3f direction{axis.normalized()};
  if (type != "point" && !(axis.length() > 0)) {
    document.warn(node_label(document, node) + " scales its light's direction to nothing; left out");
    return std::nullopt;
  }
  if (type == "point") return PointLight{position, strength};
  if (type == "directional") return DirectionalLight{direction, strength};
  if (type != "spot") {
    document.warn(what + " is of unknown type '" + type + "' and left out");
    return std::nullopt;
  }
  SpotLight spot{position, direction, strength};
  if (!read_cone(document, light["spot"], what, spot)) return std::nullopt;
  return spot;
}

}  // namespace ivory::gltf
