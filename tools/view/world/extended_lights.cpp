#include "tools/view/world/extended_lights.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tracer/lights/environment.h"

namespace ivory {

namespace {

// Enough that what they are off by is lost beside a group's extent.
constexpr std::size_t points_a_kind = 8192;

float weight_of(const ExtendedPoint& point) { return luminance(point.light); }

// Two points are neighbours where place and normal are alike: the two sides of a panel are two lights.
using Key = std::array<float, 6>;
Key key_of(const ExtendedPoint& p, float radius_m) {
  const float scale = p.n == V3f(0, 0, 0) ? 1.0F : 1 / radius_m;
  return {p.at.x * scale, p.at.y * scale, p.at.z * scale, 0.5F * p.n.x, 0.5F * p.n.y, 0.5F * p.n.z};
}

using Points = std::span<ExtendedPoint>;

// The axis along which points reach farthest, and between what.
struct Reach {
  std::size_t axis = 0;
  float low = 0;
  float high = 0;
};
Reach reach_of(Points points, float radius_m) {
  Key low;
  Key high;
  low.fill(INFINITY);
  high.fill(-INFINITY);
  for (const ExtendedPoint& p : points) {
    const Key key = key_of(p, radius_m);
    for (std::size_t axis = 0; axis < 6; ++axis) {
      low[axis] = std::min(low[axis], key[axis]);
      high[axis] = std::max(high[axis], key[axis]);
    }
  }
  Reach reach;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (axis == 0 || high[axis] - low[axis] > reach.high - reach.low) reach = {axis, low[axis], high[axis]};
  }
  return reach;
}

// In the middle of the reach, so that a sun is soon alone.
std::size_t split(Points points, float radius_m) {
  const Reach reach = reach_of(points, radius_m);
  const auto key = [&](const ExtendedPoint& p) { return key_of(p, radius_m)[reach.axis]; };
  std::stable_sort(points.begin(), points.end(),
                   [&](const ExtendedPoint& a, const ExtendedPoint& b) { return key(a) < key(b); });
  const float middle = 0.5F * (reach.low + reach.high);
  const auto at = std::find_if(points.begin(), points.end(), [&](const ExtendedPoint& p) { return key(p) > middle; });
  return std::clamp(std::size_t(at - points.begin()), std::size_t(1), points.size() - 1);
}

// What a group is off by grows with its light and with how far that reaches.
float priority_of(Points points, float radius_m) {
  if (points.size() < 2) return 0;
  float light = 0;
  for (const ExtendedPoint& p : points) light += weight_of(p);
  const Reach reach = reach_of(points, radius_m);
  return light * (reach.high - reach.low);
}

}  // namespace

int group_count(ExtendedKind kind) {
  // A point of a surface takes six layers of shadow maps, a direction one.
  return kind == ExtendedKind::environment ? int(max_lights) : int(max_shadow_layers / 6);
}

std::vector<ExtendedPoint> surface_points(const Scene& scene, const Lights& lights, ExtendedKind kind,
                                          std::size_t object) {
  std::vector<bool> is_sphere(scene.instances.size(), false);
  for (const SphereLight& light : scene.sphere_lights) {
    if (light.instance != no_index) is_sphere[std::size_t(light.instance)] = true;
  }
  std::vector<ExtendedPoint> out;
  for (const EmitterPoint& p : lights.emitter_points(points_a_kind, 1)) {
    if (is_sphere[std::size_t(p.instance)] != (kind == ExtendedKind::spheres)) continue;
    out.push_back({p.p, p.n, p.radiance_nits * p.area_m2, p.area_m2, object});
  }
  return out;
}

std::vector<ExtendedPoint> environment_points(const EnvironmentMap& map) {
  const EnvironmentLight light = make_environment_light(map);
  std::vector<ExtendedPoint> out;
  for (std::size_t i = 0; i < points_a_kind; ++i) {
    RandomStream random(1, StreamPurpose::emitter, i);
    random.begin_sample(std::uint32_t(i), 1, 6);
    const std::optional<LightSample> s = sample(light, random);
    if (!s || !(s->pdf_solid_angle > 0)) continue;
    const auto count = float(points_a_kind);
    out.push_back({s->w, V3f(0, 0, 0), s->irradiance_weight / count, 1 / (s->pdf_solid_angle * count), 0});
  }
  return out;
}

ExtendedLights make_extended_lights(ExtendedKind kind, std::vector<ExtendedPoint> points, float radius_m) {
  ExtendedLights lights{kind, std::move(points), {}};
  if (lights.points.empty()) return lights;
  lights.ends = {lights.points.size()};
  std::vector<float> priorities{priority_of(lights.points, radius_m)};
  while (int(lights.ends.size()) < group_count(kind)) {
    const auto best = std::max_element(priorities.begin(), priorities.end()) - priorities.begin();
    if (!(priorities[std::size_t(best)] > 0)) break;
    const std::size_t begin = best == 0 ? 0 : lights.ends[std::size_t(best) - 1];
    const std::size_t end = lights.ends[std::size_t(best)];
    const Points group = Points(lights.points).subspan(begin, end - begin);
    const std::size_t at = split(group, radius_m);
    lights.ends.insert(lights.ends.begin() + best, begin + at);
    priorities[std::size_t(best)] = priority_of(group.subspan(at), radius_m);
    priorities.insert(priorities.begin() + best, priority_of(group.first(at), radius_m));
  }
  return lights;
}

std::vector<RuntimeLight> small_lights(const ExtendedLights& lights, int sample, std::span<const Placement> places,
                                       const M33f& sky) {
  std::vector<RuntimeLight> out;
  const bool is_environment = lights.kind == ExtendedKind::environment;
  // Light of a piece of a surface is radiance times area.
  const auto growth = [&](const ExtendedPoint& point) {
    const float scale = is_environment ? 1.0F : places[point.object].scale;
    return scale * scale;
  };
  std::size_t begin = 0;
  for (std::size_t g = 0; g < lights.ends.size(); ++g) {
    Rgb light(0, 0, 0);
    float extent = 0;
    float total = 0;
    for (std::size_t i = begin; i < lights.ends[g]; ++i) {
      const float grown = growth(lights.points[i]);
      light += lights.points[i].light * grown;
      extent += lights.points[i].extent * grown;
      total += weight_of(lights.points[i]) * grown;
    }
    // The golden ratio's multiples spread evenly however many there are; groups begin at other places, but for the
    // first sample.
    const double u = 0.5 + double(sample) * (0.6180339887498949 + 0.7548776662466927 * double(g));
    float left = float(u - std::floor(u)) * total;
    std::size_t chosen = begin;
    const auto weight = [&](std::size_t i) { return weight_of(lights.points[i]) * growth(lights.points[i]); };
    while (chosen + 1 < lights.ends[g] && left > weight(chosen)) left -= weight(chosen++);
    const ExtendedPoint& point = lights.points[chosen];
    RuntimeLight small;
    small.intensity = light;
    // What the extent blurs nearby and in highlights shrinks with the samples, whose sum grows as sharp as the light:
    // bias and spikes both go, as radii do in progressive photon mapping.
    small.extent = extent / float(sample + 1);
    if (is_environment) {
      small.kind = LightKind::directional;
      small.direction = -point.at * sky;
    } else {
      small.kind = LightKind::patch;
      const Placement& place = places[point.object];
      small.position_m = placed(place, point.at);
      small.direction = point.n * turn_of(place);
    }
    out.push_back(small);
    begin = lights.ends[g];
  }
  return out;
}

}  // namespace ivory
