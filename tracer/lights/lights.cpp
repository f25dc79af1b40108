#include "tracer/lights/lights.h"

#include <algorithm>
#include <cmath>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/env/latlong_map.h"
#include "tracer/core/alias_table.h"
#include "tracer/lights/lights_state.h"
#include "tracer/lights/punctual.h"

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

// The instances of a mesh stand in the table triangle by triangle up to this many in all; beyond, each is one entry
// and the mesh's own table chooses the triangle.
constexpr std::size_t most_triangles_a_mesh = 4096;

}  // namespace

// In the order of instances and triangles; triangles without area or light are left out.
void Lights::State::add_emitters() {
  emissions = make_mesh_emissions(*scene);
  std::vector<std::size_t> uses(scene->meshes.size(), 0);
  for (const Instance& instance : scene->instances) ++uses[std::size_t(instance.mesh)];
  const auto whole = [&](std::size_t mesh) {
    return uses[mesh] > 1 && uses[mesh] * scene->meshes[mesh].triangles.size() > most_triangles_a_mesh;
  };
  // What stands in tables, with the weights that these are made of.
  const double tree = LightTree::bytes(1);
  double bytes = double(scene->instances.size()) * (sizeof(std::vector<int>) + sizeof(int));
  for (std::size_t m = 0; m < emissions.size(); ++m) {
    if (!emissions[m]) continue;
    const auto count = double(scene->meshes[m].triangles.size());
    bytes += whole(m) ? count * 120 + double(uses[m]) * (80 + tree)
                      : count * double(uses[m]) * (sizeof(TriangleLight) + 90 + tree);
  }
  check_memory(scene->name, bytes, "place fewer emissive triangles");

  instanced.resize(scene->meshes.size());
  triangle_index.resize(scene->instances.size());
  instance_index.assign(scene->instances.size(), no_index);
  for (std::size_t i = 0; i < scene->instances.size(); ++i) {
    const auto m = std::size_t(scene->instances[i].mesh);
    if (!emissions[m]) continue;
    if (whole(m)) {
      if (!instanced[m])
        instanced[m] = std::make_unique<const InstancedEmitter>(make_instanced_emitter(*scene, *emissions[m]));
      if (instanced[m]->triangles.empty()) continue;
      instance_index[i] = int(emitters.size());
      emitters.push_back({int(i), no_index});
      continue;
    }
    const std::size_t count = scene->meshes[m].triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
      const TriangleLight light = make_triangle_light(*scene, *emissions[m], int(i), int(t));
      if (!(light.area_m2 > 0) || is_black(light.mean_radiance)) continue;
      if (triangle_index[i].empty()) triangle_index[i].assign(count, no_index);
      triangle_index[i][t] = int(emitters.size());
      emitters.push_back({int(i), int(triangles.size())});
      triangles.push_back(light);
    }
  }
}

Lights::Lights(const Intersector& intersector) : state_(std::make_unique<State>()) {
  const Scene& scene = intersector.scene();
  State& state = *state_;
  state.scene = &scene;
  state.sphere = sphere_around(intersector);
  state.add_emitters();
  if (scene.environment) state.environment = make_environment_light(*scene.environment);

  const float area = pi * state.sphere.radius_m * state.sphere.radius_m;
  double total[3] = {0, 0, 0};
  const auto add = [&](const Rgb& power, const std::string& what) {
    if (!is_finite(power))
      throw Error(scene.name, what + " has a power that is not finite", "correct its intensity or colour");
    for (int c = 0; c < 3; ++c) total[c] += double(power[c]);
  };
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    add(power_lm(scene.lights[i], area), "light " + std::to_string(i));
  for (const Emitter& emitter : state.emitters) {
    const std::string instance = "instance " + std::to_string(emitter.instance);
    add(state.power_of(emitter), emitter.light == no_index
                                     ? "emissive " + instance
                                     : "emissive triangle " +
                                           std::to_string(state.triangles[std::size_t(emitter.light)].triangle) +
                                           " of " + instance);
  }
  if (state.environment) add(power_lm(*state.environment, area), "the environment");
  state.total_power = Rgb(float(total[0]), float(total[1]), float(total[2]));
  state.everywhere = emission(std::nullopt);
  state.choice = state.make_choice();
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
  for (const Emitter& emitter : state.emitters)
    add(state.power_of(emitter), scene.lights.size() + std::size_t(emitter.instance));
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

std::size_t Lights::count() const { return state_->environment_index() + (state_->environment ? 1 : 0); }

int Lights::node_of(std::size_t light) const {
  const State& state = *state_;
  if (light < state.punctual_count())
    return light < state.scene->light_nodes.size() ? state.scene->light_nodes[light] : no_index;
  if (is_environment(light)) return no_index;
  return state.scene->instances[std::size_t(state.emitters[light - state.punctual_count()].instance)].node;
}

bool Lights::is_environment(std::size_t light) const { return light >= state_->environment_index(); }

bool Lights::is_punctual(std::size_t light) const { return light < state_->punctual_count(); }

bool Lights::has_extended() const {
  return !state_->emitters.empty() || (state_->environment && !state_->environment->texels.empty());
}

Rgb Lights::total_power_lm() const { return state_->total_power; }

Lights::PhotonPower Lights::photon_power() const { return state_->everywhere.photon_power(); }

EmittedPhoton Lights::emit(RandomStream& random) const { return emit(state_->everywhere, random); }

EmittedPhoton Lights::emit(const Emission& emission, RandomStream& random) const {
  const State& state = *state_;
  const EntryDiscs& discs = emission.state_->discs;
  const Picks& picks = emission.state_->picks;
  if (!picks.table.empty() && emission.is_guided()) return emit_guided(emission, random);
  if (picks.table.empty()) return {state.sphere.center, V3f(0, 0, 1), Rgb(0, 0, 0)};
  const std::size_t choice = picks.table.sample(random);
  EmittedPhoton photon;
  if (choice < state.punctual_count()) {
    photon = ivory::emit(state.scene->lights[choice], discs, random);
  } else if (choice < state.environment_index()) {
    const Emitter& emitter = state.emitters[choice - state.punctual_count()];
    if (emitter.light == no_index) {
      const PickedTriangle picked = pick(*state.scene, state.instanced_of(emitter.instance), emitter.instance, random);
      photon = ivory::emit(*state.scene, picked.light, random);
      photon.power /= picked.probability;
    } else {
      photon = ivory::emit(*state.scene, state.triangles[std::size_t(emitter.light)], random);
    }
  } else {
    photon = ivory::emit(*state.environment, discs, random);
  }
  photon.power /= picks.probability[choice];
  photon.light = int(choice);
  return photon;
}

std::optional<LightSample> Lights::sample(const V3f& p, RandomStream& random) const {
  const State& state = *state_;
  const Picks& picks = state.picks();
  if (picks.table.empty()) return std::nullopt;
  const std::size_t choice = picks.table.sample(random);
  float probability = picks.probability[choice];
  std::optional<LightSample> s;
  if (choice < state.punctual_count()) {
    s = ivory::sample(state.scene->lights[choice], p);
  } else if (choice < state.environment_index()) {
    const Emitter& emitter = state.emitters[choice - state.punctual_count()];
    if (emitter.light == no_index) {
      const PickedTriangle picked = pick(*state.scene, state.instanced_of(emitter.instance), emitter.instance, random);
      s = ivory::sample(*state.scene, picked.light, p, random);
      probability *= picked.probability;
    } else {
      s = ivory::sample(*state.scene, state.triangles[std::size_t(emitter.light)], p, random);
    }
  } else {
    s = ivory::sample(*state.environment, random);
  }
  if (!s) return s;
  s->irradiance_weight /= probability;
  s->pdf_solid_angle *= probability;
  return s;
}

// Of the point of a hit on an emissive triangle once its light is picked, 1/sr.
float Lights::pdf_of_point(const V3f& p, const Hit& hit) const {
  const State& state = *state_;
  const int whole = state.instance_index[std::size_t(hit.instance)];
  if (whole == no_index) {
    const int emitter = state.triangle_index[std::size_t(hit.instance)][std::size_t(hit.triangle)];
    const TriangleLight& light = state.triangles[std::size_t(state.emitters[std::size_t(emitter)].light)];
    return ivory::pdf_solid_angle(*state.scene, light, p, hit.barycentric);
  }
  const InstancedEmitter& emitter = state.instanced_of(hit.instance);
  const int entry = emitter.entry[std::size_t(hit.triangle)];
  if (entry == no_index) return 0;
  const TriangleLight light = make_triangle_light(*state.scene, *emitter.emission, hit.instance, hit.triangle);
  return emitter.probability[std::size_t(entry)] * ivory::pdf_solid_angle(*state.scene, light, p, hit.barycentric);
}

float Lights::pdf_solid_angle(const V3f& p, const Hit& hit) const {
  const std::optional<std::uint32_t> light = state_->light_at(hit);
  return light ? state_->picks().probability[*light] * pdf_of_point(p, hit) : 0.0F;
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
