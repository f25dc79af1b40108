#include "tracer/lights_punctual.h"

#include <algorithm>
#include <cmath>

#include "tracer/sampling.h"

namespace ivory {

namespace {

// KHR_lights_punctual: the intensity at cosine c from the axis is I a(c)^2 with
// a(c) = clamp((c - c_outer) / max(0.001, c_inner - c_outer), 0, 1).
struct SpotCone {
  float cos_outer;
  float width;  // in cosine, of the zone where a rises from 0 to 1
  float rise;   // the part of that zone inside the sphere of directions (c <= 1)
};

SpotCone cone_of(const SpotLight& light) {
  SpotCone cone{};
  cone.cos_outer = std::cos(light.outer_angle_rad);
  cone.width = std::max(0.001F, std::cos(light.inner_angle_rad) - cone.cos_outer);
  cone.rise = std::min(cone.width, 1.0F - cone.cos_outer);
  return cone;
}

float falloff(const SpotCone& cone, float cosine) {
  const float a = std::clamp((cosine - cone.cos_outer) / cone.width, 0.0F, 1.0F);
  return a * a;
}

// Integrals of a^2 over cosine, in the zone where a = 1 and in the zone where it rises:
// integral of (x/width)^2 dx from 0 to rise.
float plateau_integral(const SpotCone& cone) { return std::max(0.0F, 1.0F - cone.cos_outer - cone.width); }
float rise_integral(const SpotCone& cone) { return cone.rise * cone.rise * cone.rise / (3 * cone.width * cone.width); }

Rgb power_of(const PointLight& light, const BoundingSphere&) { return light.intensity_cd * (4 * pi); }
Rgb power_of(const SpotLight& light, const BoundingSphere&) {
  const SpotCone cone = cone_of(light);
  return light.intensity_cd * (2 * pi * (plateau_integral(cone) + rise_integral(cone)));
}
Rgb power_of(const DirectionalLight& light, const BoundingSphere& sphere) {
  return light.illuminance_lux * (pi * sphere.radius_m * sphere.radius_m);
}

EmittedPhoton emit_from(const PointLight& light, const BoundingSphere& sphere, RandomStream& random) {
  return {light.position, sample_sphere(random.next2()), power_of(light, sphere)};
}

// Sampled in proportion to a^2, so every photon carries the whole flux. In the rising zone the
// density in x = c - c_outer goes as x^2, whose inverse cumulative is a cube root.
EmittedPhoton emit_from(const SpotLight& light, const BoundingSphere& sphere, RandomStream& random) {
  const SpotCone cone = cone_of(light);
  const float plateau = plateau_integral(cone);
  const float u_zone = random.next() * (plateau + rise_integral(cone));
  const V2f u = random.next2();
  const float cosine =
      u_zone < plateau ? 1.0F - u.x * plateau : std::min(1.0F, cone.cos_outer + cone.rise * std::cbrt(1.0F - u.x));
  return {light.position, make_frame(light.direction).to_world(direction_at_cosine(cosine, u.y)).normalized(),
          power_of(light, sphere)};
}

EmittedPhoton emit_from(const DirectionalLight& light, const BoundingSphere& sphere, RandomStream& random) {
  const Frame frame = make_frame(light.direction);
  const V2f disc = sample_disc(random.next2()) * sphere.radius_m;
  // Twice the radius back: clear of the sphere despite rounding.
  const V3f origin = sphere.center - light.direction * (2 * sphere.radius_m) + frame.x * disc.x + frame.y * disc.y;
  return {origin, light.direction, power_of(light, sphere)};
}

std::optional<LightSample> sample_from(const V3f& position, const Rgb& intensity, const V3f& p) {
  const V3f d = position - p;
  const float r2 = d.dot(d);
  if (!(r2 > 0)) return std::nullopt;
  const float r = std::sqrt(r2);
  return LightSample{d / r, r, intensity / r2, 0, true};
}

std::optional<LightSample> sample_at(const PointLight& light, const V3f& p) {
  return sample_from(light.position, light.intensity_cd, p);
}
std::optional<LightSample> sample_at(const SpotLight& light, const V3f& p) {
  std::optional<LightSample> s = sample_from(light.position, light.intensity_cd, p);
  if (!s) return s;
  const float a = falloff(cone_of(light), -s->w.dot(light.direction));
  if (a == 0) return std::nullopt;
  s->irradiance_weight *= a;
  return s;
}
std::optional<LightSample> sample_at(const DirectionalLight& light, const V3f&) {
  return LightSample{-light.direction, std::numeric_limits<float>::infinity(), light.illuminance_lux, 0, true};
}

}  // namespace

Rgb power_lm(const PunctualLight& light, const BoundingSphere& sphere) {
  return std::visit([&](const auto& l) { return power_of(l, sphere); }, light);
}

EmittedPhoton emit(const PunctualLight& light, const BoundingSphere& sphere, RandomStream& random) {
  return std::visit([&](const auto& l) { return emit_from(l, sphere, random); }, light);
}

std::optional<LightSample> sample(const PunctualLight& light, const V3f& p) {
  return std::visit([&](const auto& l) { return sample_at(l, p); }, light);
}

}  // namespace ivory
