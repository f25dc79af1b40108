#include "tools/input/hints.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "tracer/core/sampling.h"

namespace ivory {

namespace {

// Strongest channel.
float strength(const Rgb& light) { return std::max({light.x, light.y, light.z}); }

// The brightest lamps that stand in rooms (a 20,000 lm floodlight) have 1,600 cd all around, or 100,000 cd in a narrow
// beam; programs that turn watts of radiant flux into candela by 683 lm/W make 54,000 cd of the usual 1,000 W.
constexpr float most_usual_point_cd = 20'000;
constexpr float most_usual_spot_cd = 1'000'000;
// The sun gives 100,000 to 130,000 lux.
constexpr float most_usual_sun_lux = 150'000;
constexpr float lumen_a_watt = 683;

std::string too_bright(const char* kind, std::size_t index, float value, const char* unit) {
  return fmt::format(
      "{} light {} has {:.4g} {}, more than any usual one: if its program turned watts into candela by 683 lm/W, its "
      "light is {:.4g} {} and all lights of the file are {} times too bright",
      kind, index, value, unit, value / lumen_a_watt, unit, lumen_a_watt);
}

// Is every way out of p blocked within a small part of the scene? What stands so is a lamp in the model of its bulb.
// The farthest blocker's distance, or nothing.
std::optional<float> enclosed_within_m(const LitScene& lit, const V3f& p) {
  constexpr int directions = 128;
  const float near = 0.05F * lit.intersector.radius_m();
  float farthest = 0;
  for (int i = 0; i < directions; ++i) {
    Ray ray;
    ray.origin = p;
    ray.direction = sample_sphere(V2f((float(i) + 0.5F) / directions, std::fmod(float(i) * 0.618034F, 1.0F)));
    ray.t_max = near;
    const auto hit = lit.intersector.closest(ray);
    if (!hit) return std::nullopt;
    farthest = std::max(farthest, hit->t);
  }
  return farthest;
}

}  // namespace

std::vector<std::string> hints(const LitScene& lit) {
  std::vector<std::string> lines;
  if (lit.lights.empty()) lines.emplace_back("nothing shines: no light, no material that emits, no environment");
  const auto& lights = lit.scene->lights;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    V3f position;
    if (const auto* point = std::get_if<PointLight>(&lights[i])) {
      position = point->position;
      if (const float cd = strength(point->intensity_cd); cd > most_usual_point_cd)
        lines.push_back(too_bright("point", i, cd, "cd"));
    } else if (const auto* spot = std::get_if<SpotLight>(&lights[i])) {
      position = spot->position;
      if (const float cd = strength(spot->intensity_cd); cd > most_usual_spot_cd)
        lines.push_back(too_bright("spot", i, cd, "cd"));
    } else {
      if (const float lux = strength(std::get<DirectionalLight>(lights[i]).illuminance_lux); lux > most_usual_sun_lux)
        lines.push_back(too_bright("directional", i, lux, "lux"));
      continue;
    }
    if (const auto within_m = enclosed_within_m(lit, position)) {
      lines.push_back(
          fmt::format("light {} stands inside geometry that lets nothing out ({:.3g} m around it): leave "
                      "that node out, or make its material emit instead",
                      i, *within_m));
    }
  }
  return lines;
}

}  // namespace ivory
