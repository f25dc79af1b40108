#include "tracer/lights/lights.h"

#include <algorithm>
#include <cmath>

#include "grid/base/error.h"
#include "grid/env/latlong_map.h"
#include "tracer/core/alias_table.h"
#include "tracer/lights/environment.h"
#include "tracer/lights/punctual.h"
#include "tracer/lights/triangle.h"

namespace ivory {

namespace {

bool is_directional(const PunctualLight& light) { return std::holds_alternative<DirectionalLight>(light); }

bool is_finite(const Rgb& c) { return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z); }

// Nothing outside holds light in check, so a scene without triangles gets a sphere of 1 m.
BoundingSphere sphere_around(const Intersector& intersector) {
  const float radius = intersector.radius_m();
  return radius > 0 ? BoundingSphere{intersector.center(), radius} : BoundingSphere{V3f(0, 0, 0), 1.0F};
}

// Who is picked. By power alone, a sun, whose power is that through the disc over the whole scene, leaves a lamp
// indoors one pick in a million: what it lights gets its mean from fireflies. Nobody knows beforehand who lights
// what, so half of the picks go by power and half evenly over the groups: each punctual light, each instance that
// emits, the environment. With q the share of a group and p its share of power,
//
//   q = p / 2 + 1 / (2 groups)     so that   q >= p / 2,   q >= 1 / (2 groups):
//
// no estimate has more than twice the variance of picking by power, lights of equal power and single lights are
// picked as by power, and none is starved. Inside an instance triangles share by power. Power is that of the
// strongest channel: by luminance a blue lamp would get a fourteenth of the picks of a white one of the same
// radiant power. `group` holds a number below `groups` for each light.
std::vector<double> pick_weights(const std::vector<double>& power, const std::vector<std::size_t>& group,
                                 std::size_t groups) {
  std::vector<double> group_power(groups, 0);
  for (std::size_t i = 0; i < power.size(); ++i) group_power[group[i]] += power[i];
  double total = 0;
  double shining = 0;
  for (const double p : group_power) {
    total += p;
    if (p > 0) shining += 1;
  }
  std::vector<double> weights(power.size(), 0);
  for (std::size_t i = 0; i < power.size(); ++i) {
    if (power[i] > 0) weights[i] = 0.5 * power[i] / total + 0.5 * power[i] / group_power[group[i]] / shining;
  }
  return weights;
}

struct Picks {
  AliasTable table;
  std::vector<float> probability;  // of picking each light
};

}  // namespace

struct Lights::Emission::State {
  EntryDiscs discs;
  Picks picks;
  PhotonPower photon_power;
};

// Lights are numbered punctual first, then triangles, then the environment.
struct Lights::State {
  const Scene* scene = nullptr;
  BoundingSphere sphere;
  std::vector<TriangleLight> triangles;
  std::vector<std::vector<int>> triangle_index;  // [instance][triangle] -> triangles; empty for dark instances
  std::optional<EnvironmentLight> environment;
  Emission everywhere;  // without a target; its picks are sample()'s, too
  Rgb total_power{0, 0, 0};

  const Picks& picks() const { return everywhere.state_->picks; }
  std::size_t punctual_count() const { return scene->lights.size(); }
  std::size_t environment_index() const { return punctual_count() + triangles.size(); }
};

Lights::Lights(const Intersector& intersector) : state_(std::make_unique<State>()) {
  const Scene& scene = intersector.scene();
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

  const float area = pi * state.sphere.radius_m * state.sphere.radius_m;
  double total[3] = {0, 0, 0};
  const auto add = [&](const Rgb& power, const std::string& what) {
    if (!is_finite(power))
      throw Error(scene.name, what + " has a power that is not finite", "correct its intensity or colour");
    for (int c = 0; c < 3; ++c) total[c] += double(power[c]);
  };
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    add(power_lm(scene.lights[i], area), "light " + std::to_string(i));
  for (const TriangleLight& light : state.triangles)
    add(power_lm(light),
        "emissive triangle " + std::to_string(light.triangle) + " of instance " + std::to_string(light.instance));
  if (state.environment) add(power_lm(*state.environment, area), "the environment");
  state.total_power = Rgb(float(total[0]), float(total[1]), float(total[2]));
  state.everywhere = emission(std::nullopt);
}

Lights::Emission Lights::emission(const std::optional<EmissionTarget>& target) const {
  const State& state = *state_;
  const Scene& scene = *state.scene;
  auto made = std::make_shared<Emission::State>();
  const bool from_afar = state.environment || std::ranges::any_of(scene.lights, is_directional);
  // The bounds of a large scene take their time.
  made->discs = target && from_afar ? make_entry_discs(state.sphere, bounds(scene), target)
                                    : make_entry_discs(state.sphere, {}, std::nullopt);
  const float area = near_area_m2(made->discs);
  const double heavier = double(far_area_m2(made->discs)) / double(area);

  std::vector<double> powers;
  std::vector<std::size_t> groups;
  const auto add = [&](const Rgb& power, std::size_t group) {
    powers.push_back(std::max(0.0, double(max_component(power))));
    groups.push_back(group);
  };
  for (std::size_t i = 0; i < scene.lights.size(); ++i) add(power_lm(scene.lights[i], area), i);
  for (const TriangleLight& light : state.triangles)
    add(power_lm(light), scene.lights.size() + std::size_t(light.instance));
  const std::size_t environment_group = scene.lights.size() + scene.instances.size();
  if (state.environment) add(power_lm(*state.environment, area), environment_group);

  made->picks.table = AliasTable(pick_weights(powers, groups, environment_group + 1));
  made->picks.probability.assign(powers.size(), 0.0F);
  const std::vector<double> probabilities = made->picks.table.probabilities();
  std::ranges::transform(probabilities, made->picks.probability.begin(), [](double p) { return float(p); });
  std::vector<double> group_power(environment_group + 1, 0);
  std::vector<double> group_probability(environment_group + 1, 0);
  for (std::size_t i = 0; i < probabilities.size(); ++i) {
    group_power[groups[i]] += powers[i];
    group_probability[groups[i]] += probabilities[i];
  }
  for (std::size_t g = 0; g < group_power.size(); ++g) {
    if (group_probability[g] == 0) continue;
    const double power = group_power[g] / group_probability[g];
    const bool enters = g == environment_group || (g < scene.lights.size() && is_directional(scene.lights[g]));
    PhotonPower& range = made->photon_power;
    range.weakest_lm = range.strongest_lm == 0 ? float(power) : std::min(range.weakest_lm, float(power));
    range.strongest_lm = std::max(range.strongest_lm, float(power));
    range.heaviest_lm = std::max(range.heaviest_lm, float(enters ? power * heavier : power));
  }
  Emission emission;
  emission.state_ = std::move(made);
  return emission;
}

Lights::PhotonPower Lights::Emission::photon_power() const { return state_->photon_power; }
const EntryDiscs& Lights::Emission::discs() const { return state_->discs; }

Lights::~Lights() = default;
Lights::Lights(Lights&&) noexcept = default;
Lights& Lights::operator=(Lights&&) noexcept = default;

bool Lights::empty() const { return state_->picks().table.empty(); }

bool Lights::has_extended() const {
  return !state_->triangles.empty() || (state_->environment && !state_->environment->texels.empty());
}

Rgb Lights::total_power_lm() const { return state_->total_power; }

Lights::PhotonPower Lights::photon_power() const { return state_->everywhere.photon_power(); }

EmittedPhoton Lights::emit(RandomStream& random) const { return emit(state_->everywhere, random); }

EmittedPhoton Lights::emit(const Emission& emission, RandomStream& random) const {
  const State& state = *state_;
  const auto& [discs, picks, power] = *emission.state_;
  if (picks.table.empty()) return {state.sphere.center, V3f(0, 0, 1), Rgb(0, 0, 0)};
  const std::size_t pick = picks.table.sample(random);
  EmittedPhoton photon;
  if (pick < state.punctual_count()) {
    photon = ivory::emit(state.scene->lights[pick], discs, random);
  } else if (pick < state.environment_index()) {
    photon = ivory::emit(*state.scene, state.triangles[pick - state.punctual_count()], random);
  } else {
    photon = ivory::emit(*state.environment, discs, random);
  }
  photon.power /= picks.probability[pick];
  return photon;
}

std::optional<LightSample> Lights::sample(const V3f& p, RandomStream& random) const {
  const State& state = *state_;
  const Picks& picks = state.picks();
  if (picks.table.empty()) return std::nullopt;
  const std::size_t pick = picks.table.sample(random);
  std::optional<LightSample> s;
  if (pick < state.punctual_count()) {
    s = ivory::sample(state.scene->lights[pick], p);
  } else if (pick < state.environment_index()) {
    s = ivory::sample(*state.scene, state.triangles[pick - state.punctual_count()], p, random);
  } else {
    s = ivory::sample(*state.environment, random);
  }
  if (!s) return s;
  s->irradiance_weight /= picks.probability[pick];
  s->pdf_solid_angle *= picks.probability[pick];
  return s;
}

float Lights::pdf_solid_angle(const V3f& p, const Hit& hit) const {
  const State& state = *state_;
  const auto& index = state.triangle_index[std::size_t(hit.instance)];
  if (index.empty()) return 0;
  const int light = index[std::size_t(hit.triangle)];
  if (light == no_index) return 0;
  return state.picks().probability[state.punctual_count() + std::size_t(light)] *
         ivory::pdf_solid_angle(state.triangles[std::size_t(light)], p, hit.barycentric);
}

float Lights::environment_pdf_solid_angle(const V3f& w) const {
  const State& state = *state_;
  if (!state.environment) return 0;
  return state.picks().probability[state.environment_index()] * ivory::pdf_solid_angle(*state.environment, w);
}

Rgb Lights::environment_radiance(const V3f& w) const {
  const State& state = *state_;
  return state.environment ? eval(*state.environment->map, w) : Rgb(0, 0, 0);
}

}  // namespace ivory
