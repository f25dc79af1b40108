#include "tracer/lights.h"

#include <cmath>

#include "grid/error.h"
#include "tracer/alias_table.h"
#include "tracer/environment.h"
#include "tracer/lights_environment.h"
#include "tracer/lights_punctual.h"
#include "tracer/lights_triangle.h"

namespace ivory {

namespace {

bool is_finite(const Rgb& c) { return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z); }

// Nothing outside holds light in check, so a scene without triangles gets a sphere of 1 m.
BoundingSphere sphere_around(const Intersector& intersector) {
  const float radius = intersector.radius_m();
  return radius > 0 ? BoundingSphere{intersector.center(), radius} : BoundingSphere{V3f(0, 0, 0), 1.0F};
}

}  // namespace

// Lights are numbered punctual first, then triangles, then the environment.
struct Lights::State {
  const Scene* scene = nullptr;
  BoundingSphere sphere;
  std::vector<TriangleLight> triangles;
  std::vector<std::vector<int>> triangle_index;  // [instance][triangle] -> triangles; empty for dark instances
  std::optional<EnvironmentLight> environment;
  AliasTable table;
  std::vector<float> probability;  // of picking each light
  Rgb total_power{0, 0, 0};

  std::size_t punctual_count() const { return scene->lights.size(); }
  std::size_t environment_index() const { return punctual_count() + triangles.size(); }
};

Lights::Lights(const Scene& scene, const Intersector& intersector) : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.scene = &scene;
  state.sphere = sphere_around(intersector);
  state.triangles = make_triangle_lights(scene);
  if (scene.environment) state.environment = make_environment_light(*scene.environment);

  state.triangle_index.resize(scene.instances.size());
  for (std::size_t i = 0; i < state.triangles.size(); ++i) {
    const TriangleLight& light = state.triangles[i];
    auto& index = state.triangle_index[std::size_t(light.instance)];
    if (index.empty()) {
      const int mesh = scene.instances[std::size_t(light.instance)].mesh;
      index.assign(scene.meshes[std::size_t(mesh)].triangles.size(), no_index);
    }
    index[std::size_t(light.triangle)] = int(i);
  }

  std::vector<double> weights;
  double total[3] = {0, 0, 0};
  const auto add = [&](const Rgb& power, const std::string& what) {
    if (!is_finite(power))
      throw Error(scene.name, what + " has a power that is not finite", "correct its intensity or colour");
    weights.push_back(double(luminance(power)));
    for (int c = 0; c < 3; ++c) total[c] += double(power[c]);
  };
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    add(power_lm(scene.lights[i], state.sphere), "light " + std::to_string(i));
  for (const TriangleLight& light : state.triangles)
    add(power_lm(light),
        "emissive triangle " + std::to_string(light.triangle) + " of instance " + std::to_string(light.instance));
  if (state.environment) add(power_lm(*state.environment, state.sphere), "the environment");

  state.table = AliasTable(weights);
  state.total_power = Rgb(float(total[0]), float(total[1]), float(total[2]));
  state.probability.reserve(weights.size());
  for (const double weight : weights)
    state.probability.push_back(state.table.empty() ? 0.0F : float(weight / state.table.total()));
}

Lights::~Lights() = default;
Lights::Lights(Lights&&) noexcept = default;
Lights& Lights::operator=(Lights&&) noexcept = default;

bool Lights::empty() const { return state_->table.empty(); }

bool Lights::has_extended() const {
  return !state_->triangles.empty() || (state_->environment && !state_->environment->texels.empty());
}

Rgb Lights::total_power_lm() const { return state_->total_power; }

EmittedPhoton Lights::emit(RandomStream& random) const {
  const State& state = *state_;
  if (state.table.empty()) return {state.sphere.center, V3f(0, 0, 1), Rgb(0, 0, 0)};
  const std::size_t pick = state.table.sample(random);
  EmittedPhoton photon;
  if (pick < state.punctual_count()) {
    photon = ivory::emit(state.scene->lights[pick], state.sphere, random);
  } else if (pick < state.environment_index()) {
    photon = ivory::emit(*state.scene, state.triangles[pick - state.punctual_count()], random);
  } else {
    photon = ivory::emit(*state.environment, state.sphere, random);
  }
  photon.power /= state.probability[pick];
  return photon;
}

std::optional<LightSample> Lights::sample(const V3f& p, RandomStream& random) const {
  const State& state = *state_;
  if (state.table.empty()) return std::nullopt;
  const std::size_t pick = state.table.sample(random);
  std::optional<LightSample> s;
  if (pick < state.punctual_count()) {
    s = ivory::sample(state.scene->lights[pick], p);
  } else if (pick < state.environment_index()) {
    s = ivory::sample(*state.scene, state.triangles[pick - state.punctual_count()], p, random);
  } else {
    s = ivory::sample(*state.environment, random);
  }
  if (!s) return s;
  s->irradiance_weight /= state.probability[pick];
  s->pdf_solid_angle *= state.probability[pick];
  return s;
}

float Lights::pdf_solid_angle(const V3f& p, const Hit& hit) const {
  const State& state = *state_;
  const auto& index = state.triangle_index[std::size_t(hit.instance)];
  if (index.empty()) return 0;
  const int light = index[std::size_t(hit.triangle)];
  if (light == no_index) return 0;
  return state.probability[state.punctual_count() + std::size_t(light)] *
         ivory::pdf_solid_angle(state.triangles[std::size_t(light)], p, hit.barycentric);
}

float Lights::environment_pdf_solid_angle(const V3f& w) const {
  const State& state = *state_;
  if (!state.environment) return 0;
  return state.probability[state.environment_index()] * ivory::pdf_solid_angle(*state.environment, w);
}

Rgb Lights::environment_radiance(const V3f& w) const {
  const State& state = *state_;
  return state.environment ? eval(*state.environment->map, w) : Rgb(0, 0, 0);
}

}  // namespace ivory
