// Sampling lights for a receiver: what LightChoice needs to know of each, and the light that it has chosen.
#include <algorithm>
#include <cmath>

#include "tracer/lights/lights_state.h"
#include "tracer/lights/punctual.h"

namespace ivory {

namespace {

LightBounds bounds_of(const PointLight& light) {
  LightBounds bounds;
  bounds.box.extendBy(light.position);
  bounds.spread_rad = pi;
  bounds.intensity_cd = max_component(light.intensity_cd);
  return bounds;
}

LightBounds bounds_of(const SpotLight& light) {
  LightBounds bounds;
  bounds.box.extendBy(light.position);
  bounds.axis = light.direction;
  bounds.spread_rad = light.inner_angle_rad;
  // Wider by what rounding may turn directions.
  bounds.reach_rad = light.outer_angle_rad - light.inner_angle_rad + 1e-3F;
  bounds.intensity_cd = max_component(light.intensity_cd);
  return bounds;
}

// Another kind of choice is made for it.
LightBounds bounds_of(const DirectionalLight&) { return {}; }

LightBounds bounds_of(const TriangleLight& light) {
  LightBounds bounds;
  bounds.box.extendBy(light.vertex);
  bounds.box.extendBy(light.vertex + light.edge1);
  bounds.box.extendBy(light.vertex + light.edge2);
  bounds.axis = light.ng;
  bounds.reach_rad = pi / 2;
  bounds.two_sided = light.double_sided;
  bounds.intensity_cd = max_component(light.mean_radiance) * light.area_m2;
  return bounds;
}

// Of a mesh that shines to all sides, about: the mean intensity over directions.
LightBounds bounds_of(const Scene& scene, const InstancedEmitter& emitter, int instance) {
  LightBounds bounds;
  const Mesh& mesh = scene.meshes[std::size_t(emitter.emission->mesh)];
  const M44f& to_world = scene.instances[std::size_t(instance)].to_world;
  Box3f box;
  for (const int triangle : emitter.triangles) {
    const auto& corners = mesh.triangles[std::size_t(triangle)];
    for (const std::uint32_t v : {corners.x, corners.y, corners.z}) box.extendBy(mesh.positions[v]);
  }
  for (int i = 0; i < 8; ++i) {
    const V3f corner((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                     (i & 4) != 0 ? box.max.z : box.min.z);
    bounds.box.extendBy(corner * to_world);
  }
  bounds.spread_rad = pi;
  bounds.intensity_cd = max_component(power_lm(scene, emitter, instance)) / (4 * pi);
  return bounds;
}

}  // namespace

LightChoice Lights::State::make_choice() const {
  std::vector<LightFromAfar> from_afar;
  const std::size_t count = environment_index() + (environment ? 1 : 0);
  std::vector<LightBounds> bounds(count);
  std::vector<std::vector<std::uint32_t>> groups;
  for (std::size_t i = 0; i < punctual_count(); ++i) {
    if (const auto* sun = std::get_if<DirectionalLight>(&scene->lights[i])) {
      from_afar.push_back({std::uint32_t(i), -sun->direction, max_component(sun->illuminance_lux)});
      continue;
    }
    bounds[i] = std::visit([](const auto& light) { return bounds_of(light); }, scene->lights[i]);
    groups.push_back({std::uint32_t(i)});
  }
  int instance = no_index;
  for (std::size_t i = 0; i < emitters.size(); ++i) {
    const Emitter& emitter = emitters[i];
    const std::size_t light = punctual_count() + i;
    bounds[light] = emitter.light == no_index ? bounds_of(*scene, instanced_of(emitter.instance), emitter.instance)
                                              : bounds_of(triangles[std::size_t(emitter.light)]);
    if (emitter.instance != instance) groups.emplace_back();
    instance = emitter.instance;
    groups.back().push_back(std::uint32_t(light));
  }
  // A sky of one radiance L gives pi L, a quarter of its integral.
  if (environment && !environment->texels.empty())
    from_afar.push_back(
        {std::uint32_t(environment_index()), V3f(0, 0, 0), max_component(environment->radiance_integral) / 4});
  return {std::move(from_afar), bounds, groups};
}

std::optional<std::uint32_t> Lights::State::light_at(const Hit& hit) const {
  const auto instance = std::size_t(hit.instance);
  const auto light = [&](int emitter) { return std::uint32_t(punctual_count() + std::size_t(emitter)); };
  if (instance_index[instance] != no_index) return light(instance_index[instance]);
  const std::vector<int>& index = triangle_index[instance];
  if (index.empty() || index[std::size_t(hit.triangle)] == no_index) return std::nullopt;
  return light(index[std::size_t(hit.triangle)]);
}

int Lights::samples(LightPick pick) const { return state_->choice.samples(pick); }

// One point of the unit square chooses the light and the place on it, so that samples that are even in the square are
// so over all lights together.
std::optional<LightSample> Lights::sample(const Receiver& receiver, LightPick pick, int i, RandomStream& random) const {
  const State& state = *state_;
  const std::array<std::uint32_t, 2> point = random.next_pair();
  double u = double(point[0]) * 0x1p-32;
  // Among many the choice would leave few bits for the place.
  if (state.emitters.size() > 256) u += double(random.next_u32()) * 0x1p-64;
  const std::optional<LightChoice::Chosen> chosen = state.choice.choose(receiver, pick, i, std::min(u, 1 - 0x1p-53));
  if (!chosen) return std::nullopt;
  const auto light = std::size_t(chosen->light);
  float probability = chosen->probability;
  const Imath::V2d at(chosen->u, double(point[1]) * 0x1p-32);
  std::optional<LightSample> s;
  if (light < state.punctual_count()) {
    s = ivory::sample(state.scene->lights[light], receiver.p);
  } else if (light == state.environment_index()) {
    s = ivory::sample(*state.environment, at);
  } else {
    const Emitter& emitter = state.emitters[light - state.punctual_count()];
    if (emitter.light == no_index) {
      const PickedTriangle picked =
          ivory::pick(*state.scene, state.instanced_of(emitter.instance), emitter.instance, random);
      probability *= picked.probability;
      s = ivory::sample(*state.scene, picked.light, receiver.p, at, random);
    } else {
      s = ivory::sample(*state.scene, state.triangles[std::size_t(emitter.light)], receiver.p, at, random);
    }
  }
  if (!s) return s;
  s->irradiance_weight /= probability;
  s->pdf_solid_angle *= probability;
  return s;
}

float Lights::pdf_solid_angle(const Receiver& receiver, const Hit& hit, LightPick pick) const {
  const State& state = *state_;
  const std::optional<std::uint32_t> light = state.light_at(hit);
  if (!light) return 0;
  const float pdf = pdf_of_point(receiver.p, hit);
  return pdf > 0 ? pdf * state.choice.probability(receiver, *light, pick) : 0.0F;
}

float Lights::environment_pdf_solid_angle(const Receiver& receiver, const V3f& w, LightPick pick) const {
  const State& state = *state_;
  if (!state.environment) return 0;
  const float pdf = ivory::pdf_solid_angle(*state.environment, w);
  return pdf > 0 ? pdf * state.choice.probability(receiver, std::uint32_t(state.environment_index()), pick) : 0.0F;
}

}  // namespace ivory
