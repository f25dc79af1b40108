#include "tracer/lights/punctual.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "grid/base/circle.h"
#include "tracer/core/sampling.h"

namespace ivory {

namespace {

// KHR_lights_punctual: the intensity at cosine c from the axis is I a(c)^2 with
// a(c) = clamp((c - c_outer) / (c_inner - c_outer), 0, 1).
// The extension's sample code has at least 0.001 for the difference, against division by zero: a cone of 2 degrees
// would get a third of its intensity. Here the zone is as narrow as the file says, down to a millionth of the cone.
// Kept as x = 1 - c, in double and without the difference: for a cone of 1e-4 rad 1 - cos is 5e-9, less than
// float's spacing below 1.
struct SpotCone {
  double outer;  // 1 - c_outer
  double width;  // of the zone where a rises from 0 to 1
  double rise;   // the part of that zone inside the sphere of directions (x >= 0)
};

double one_minus_cosine(float angle_rad) {
  const double s = std::sin(0.5 * double(angle_rad));
  return 2 * s * s;
}

SpotCone cone_of(const SpotLight& light) {
  SpotCone cone{};
  cone.outer = one_minus_cosine(light.outer_angle_rad);
  constexpr double narrowest = 1e-6;
  cone.width = std::max({cone.outer - one_minus_cosine(light.inner_angle_rad), narrowest * cone.outer, 1e-300});
  cone.rise = std::min(cone.width, cone.outer);
  return cone;
}

// a^2 along unit w, seen from the light. 1 - c = sin^2 / (1 + c), with the sine from the cross product.
float falloff(const SpotCone& cone, const V3f& axis, const V3f& w) {
  const double cosine = double(axis.dot(w));
  const double sine2 = double(axis.cross(w).length2());
  const double x = cosine > 0 ? sine2 / (1 + cosine) : 1 - cosine;
  const double a = std::clamp((cone.outer - x) / cone.width, 0.0, 1.0);
  return float(a * a);
}

// Integrals of a^2 over x, in the zone where a = 1 and in the zone where it rises:
// integral of (y/width)^2 dy from 0 to rise.
double plateau_integral(const SpotCone& cone) { return std::max(0.0, cone.outer - cone.width); }
double rise_integral(const SpotCone& cone) { return cone.rise * cone.rise * cone.rise / (3 * cone.width * cone.width); }

Rgb power_of(const PointLight& light, float) { return light.intensity_cd * (4 * pi); }
Rgb power_of(const SpotLight& light, float) {
  const SpotCone cone = cone_of(light);
  return light.intensity_cd * float(2 * double(pi) * (plateau_integral(cone) + rise_integral(cone)));
}
Rgb power_of(const DirectionalLight& light, float entry_area_m2) { return light.illuminance_lux * entry_area_m2; }

EmittedPhoton emit_from(const PointLight& light, const EntryDiscs&, RandomStream& random) {
  return {light.position, sample_sphere(random.next2()), power_of(light, 0)};
}

// Sampled in proportion to a^2, so every photon carries the whole flux. In the rising zone the
// density in y = c - c_outer goes as y^2, whose inverse cumulative is a cube root.
EmittedPhoton emit_from(const SpotLight& light, const EntryDiscs&, RandomStream& random) {
  const SpotCone cone = cone_of(light);
  const double plateau = plateau_integral(cone);
  const double u_zone = double(random.next()) * (plateau + rise_integral(cone));
  const V2f u = random.next2();
  const double x =
      u_zone < plateau ? double(u.x) * plateau : std::max(0.0, cone.outer - cone.rise * std::cbrt(1 - double(u.x)));
  const float sine = float(std::sqrt(x * (2 - x)));
  const V2f around = V2f(on_unit_circle(double(u.y))) * sine;
  const V3f local(around.x, around.y, float(1 - x));
  return {light.position, make_shading_frame(light.direction).to_world(local).normalized(), power_of(light, 0)};
}

EmittedPhoton emit_from(const DirectionalLight& light, const EntryDiscs& discs, RandomStream& random) {
  const Entry entry = sample(discs, -light.direction, make_shading_frame(light.direction), random);
  return {entry.origin, light.direction, power_of(light, entry.area_m2)};
}

// Along the cone's axis by u.x: first the plateau, then the rising zone.
EmittedPhoton emit_at(const SpotLight& light, const Imath::V2d& u) {
  const SpotCone cone = cone_of(light);
  const double plateau = plateau_integral(cone);
  const double at = u.x * (plateau + rise_integral(cone));
  const double risen = at < plateau ? 0 : (at - plateau) / rise_integral(cone);
  const double x = at < plateau ? at : std::max(0.0, cone.outer - cone.rise * std::cbrt(std::max(0.0, 1 - risen)));
  const double sine = std::sqrt(x * (2 - x));
  const V2f around(on_unit_circle(u.y) * sine);
  const V3f local(around.x, around.y, float(1 - x));
  return {light.position, make_shading_frame(light.direction).to_world(local).normalized(), power_of(light, 0)};
}
EmittedPhoton emit_at(const PointLight& light, const Imath::V2d& u) {
  return {light.position, sample_sphere(V2f(u)), power_of(light, 0)};
}
EmittedPhoton emit_at(const DirectionalLight& light, const Imath::V2d&) {
  assert(false);  // it has no place
  return {V3f(0, 0, 0), light.direction, Rgb(0, 0, 0)};
}

std::optional<LightSample> sample_from(const V3f& position, const Rgb& intensity, const V3f& p) {
  const V3f d = position - p;
  const float r2 = d.dot(d);
  if (!(r2 > 0)) return std::nullopt;
  const float r = std::sqrt(r2);
  return LightSample{d / r, r, intensity / r2, 0, true, position};
}

std::optional<LightSample> sample_at(const PointLight& light, const V3f& p) {
  return sample_from(light.position, light.intensity_cd, p);
}
std::optional<LightSample> sample_at(const SpotLight& light, const V3f& p) {
  std::optional<LightSample> s = sample_from(light.position, light.intensity_cd, p);
  if (!s) return s;
  const float a = falloff(cone_of(light), light.direction, -s->w);
  if (a == 0) return std::nullopt;
  s->irradiance_weight *= a;
  return s;
}
std::optional<LightSample> sample_at(const DirectionalLight& light, const V3f&) {
  return LightSample{-light.direction, std::numeric_limits<float>::infinity(), light.illuminance_lux, 0, true};
}

}  // namespace

Rgb power_lm(const PunctualLight& light, float entry_area_m2) {
  return std::visit([&](const auto& l) { return power_of(l, entry_area_m2); }, light);
}

EmittedPhoton emit(const PunctualLight& light, const EntryDiscs& discs, RandomStream& random) {
  return std::visit([&](const auto& l) { return emit_from(l, discs, random); }, light);
}

EmittedPhoton emit(const PunctualLight& light, const Imath::V2d& u) {
  return std::visit([&](const auto& l) { return emit_at(l, u); }, light);
}

EmittedPhoton emit(const DirectionalLight& light, const EntryDiscs& discs, std::size_t disc, const Imath::V2d& point) {
  const Entry entry = enter(discs, disc, point, -light.direction, make_shading_frame(light.direction));
  return {entry.origin, light.direction, power_of(light, entry.area_m2)};
}

std::optional<LightSample> sample(const PunctualLight& light, const V3f& p) {
  return std::visit([&](const auto& l) { return sample_at(l, p); }, light);
}

}  // namespace ivory
