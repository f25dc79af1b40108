#include "tracer/lights/strata.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "tracer/lights/lights_state.h"
#include "tracer/lights/punctual.h"

namespace ivory {

namespace {

// Lamps of less than this share of the photons form strata together.
constexpr double least_share = 1.0 / 256;

constexpr unsigned bit(unsigned axis) { return 1U << axis; }
constexpr unsigned both(unsigned axis) { return 3U << axis; }

// Ten bits an axis, interleaved.
std::uint32_t morton(const V3f& p, const BoundingSphere& sphere) {
  std::uint32_t code = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const float x = (p[axis] - sphere.center[axis]) / sphere.radius_m * 0.5F + 0.5F;
    const auto cell = std::uint32_t(std::clamp(x, 0.0F, 1.0F) * 1023);
    for (unsigned i = 0; i < 10; ++i) code |= (cell >> i & 1U) << (3 * i + axis);
  }
  return code;
}

struct Inverse {
  std::size_t index;
  double rest;
};

// Where u of the way from before[first] to before[last] falls: between which two, and how far there.
Inverse invert(const std::vector<double>& before, std::size_t first, std::size_t last, double u) {
  const double at = before[first] + u * (before[last] - before[first]);
  const auto begin = before.begin() + std::ptrdiff_t(first);
  const auto next = std::upper_bound(begin, before.begin() + std::ptrdiff_t(last), at);
  const std::size_t index = std::max<std::ptrdiff_t>(1, next - begin) - 1 + std::ptrdiff_t(first);
  const double width = before[index + 1] - before[index];
  return {index, width > 0 ? std::clamp((at - before[index]) / width, 0.0, 1 - 0x1p-32) : 0.5};
}

}  // namespace

Lights::Emission Lights::guidable(const Emission& emission) const {
  const State& state = *state_;
  const Scene& scene = *state.scene;
  const Emission::State& base = *emission.state_;
  auto made = std::make_shared<Emission::State>(base);
  auto strata = std::make_shared<Strata>();
  const auto probability = [&](std::size_t light) { return double(base.picks.probability[light]); };
  const auto add = [&](const StratumSource& source, const GuideStratum& shape) {
    strata->sources.push_back(source);
    strata->shapes.push_back(shape);
  };

  // From afar: a photon's power is that through the target's discs where they overlap, and up to that of the ring
  // between a disc and the next smaller one.
  const std::vector<double> discs = disc_shares(base.discs);
  const double far_over_near = double(far_area_m2(base.discs)) / double(near_area_m2(base.discs));
  const auto add_far = [&](StratumSource source, std::size_t light, unsigned axes, const Rgb& power) {
    if (!(probability(light) > 0)) return;
    const double near = double(max_component(power)) / probability(light);
    for (std::size_t k = 0; k < discs.size(); ++k) {
      source.disc = k;
      if (discs[k] > 0) add(source, {probability(light) * discs[k], axes, near, near * far_over_near});
    }
  };
  const float near_area = near_area_m2(base.discs);
  std::vector<std::size_t> lamps;
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    if (std::holds_alternative<DirectionalLight>(scene.lights[i])) {
      add_far({.kind = StratumSource::Kind::sun, .light = i}, i, both(axis_place),
              power_lm(scene.lights[i], near_area));
    } else {
      lamps.push_back(i);
    }
  }
  if (state.environment && probability(state.environment_index()) > 0) {
    strata->sky = make_sky_table(*state.environment);
    add_far({.kind = StratumSource::Kind::sky}, state.environment_index(), both(axis_place) | both(axis_direction),
            power_lm(*state.environment, near_area));
  }

  // Lamps and emissive instances, neighbours in a row.
  struct Group {
    std::uint32_t place;
    std::vector<std::size_t> lights;
  };
  const auto place_of = [&](const Emitter& emitter) {
    if (emitter.light != no_index) return state.triangles[std::size_t(emitter.light)].vertex;
    const Instance& instance = scene.instances[std::size_t(emitter.instance)];
    return scene.meshes[std::size_t(instance.mesh)].positions.front() * instance.to_world;
  };
  const auto add_groups = [&](std::vector<Group> groups, StratumSource::Kind kind, unsigned axes) {
    std::ranges::stable_sort(groups, {}, [](const Group& g) { return g.place; });
    double share = 0;
    StratumSource source{.kind = kind, .first = strata->members.size(), .last = strata->members.size()};
    GuideStratum shape;
    bool which = false;
    const auto close = [&] {
      source.last = strata->members.size();
      shape.share = share;
      shape.axes = axes | (which || source.last - source.first > 1 ? bit(axis_which) : 0);
      if (share > 0) add(source, shape);
      source.first = source.last;
      share = 0;
      which = false;
      shape = {};
    };
    for (const Group& group : groups) {
      double own = 0;
      for (const std::size_t light : group.lights) own += probability(light);
      if (share > 0 && share + own > least_share) close();
      for (const std::size_t light : group.lights) {
        if (!(probability(light) > 0)) continue;
        const bool is_lamp = light < state.punctual_count();
        const Emitter* emitter = is_lamp ? nullptr : &state.emitters[light - state.punctual_count()];
        const Rgb power = is_lamp ? power_lm(scene.lights[light], 0) : state.power_of(*emitter);
        which = which || (emitter && emitter->light == no_index);
        strata->members.push_back(light);
        strata->before.push_back(strata->before.back() + probability(light));
        const double lm = double(max_component(power)) / probability(light);
        shape.weakest_lm = shape.weakest_lm == 0 ? lm : std::min(shape.weakest_lm, lm);
        shape.heaviest_lm = std::max(shape.heaviest_lm, lm);
      }
      share += own;
    }
    close();
  };
  strata->before.push_back(0);
  std::vector<Group> groups;
  for (const std::size_t i : lamps) {
    const V3f p = std::visit(
        [](const auto& l) {
          if constexpr (requires { l.position; }) {
            return l.position;
          } else {
            return V3f(0, 0, 0);
          }
        },
        scene.lights[i]);
    groups.push_back({morton(p, state.sphere), {i}});
  }
  add_groups(std::move(groups), StratumSource::Kind::lamps, both(axis_direction));
  groups.clear();
  for (std::size_t e = 0; e < state.emitters.size(); ++e) {
    const Emitter& emitter = state.emitters[e];
    if (e == 0 || state.emitters[e - 1].instance != emitter.instance)
      groups.push_back({morton(place_of(emitter), state.sphere), {}});
    groups.back().lights.push_back(state.punctual_count() + e);
    if (emitter.light != no_index) continue;
    const InstancedEmitter& mesh = state.instanced_of(emitter.instance);
    std::vector<double>& before = strata->instanced[&mesh];
    if (!before.empty()) continue;
    before.push_back(0);
    for (const float p : mesh.probability) before.push_back(before.back() + double(p));
  }
  add_groups(std::move(groups), StratumSource::Kind::emitters, both(axis_place) | both(axis_direction));

  made->guide = EmissionGuide(strata->shapes);
  made->strata = std::move(strata);
  Emission out;
  out.state_ = std::move(made);
  return out;
}

Lights::Emission Lights::Emission::guided(EmissionGuide guide, float typical_lm) const {
  assert(state_->strata);
  auto made = std::make_shared<State>(*state_);
  made->guide = std::move(guide);
  PhotonPower& range = made->photon_power;
  range = {};
  for (std::size_t s = 0; s < made->strata->shapes.size(); ++s) {
    const GuideStratum& shape = made->strata->shapes[s];
    const auto weakest = float(shape.weakest_lm / made->guide.largest_density(std::uint32_t(s)));
    const auto heaviest = float(shape.heaviest_lm / made->guide.least_density(std::uint32_t(s)));
    range.weakest_lm = range.weakest_lm == 0 ? weakest : std::min(range.weakest_lm, weakest);
    range.heaviest_lm = std::max(range.heaviest_lm, heaviest);
  }
  range.strongest_lm = typical_lm > 0 ? typical_lm : state_->photon_power.strongest_lm;
  Emission out;
  out.state_ = std::move(made);
  return out;
}

bool Lights::Emission::is_guided() const { return state_->strata != nullptr; }
const EmissionGuide& Lights::Emission::guide() const { return state_->guide; }
const std::vector<GuideStratum>& Lights::Emission::strata() const { return state_->strata->shapes; }

EmittedPhoton Lights::emit_guided(const Emission& emission, RandomStream& random) const {
  const State& state = *state_;
  const Scene& scene = *state.scene;
  const Emission::State& from = *emission.state_;
  const Strata& strata = *from.strata;
  const GuidePoint at = from.guide.sample(random);
  const StratumSource& source = strata.sources[at.stratum];
  const Imath::V2d place(at.u[axis_place], at.u[axis_place + 1]);
  const Imath::V2d direction(at.u[axis_direction], at.u[axis_direction + 1]);
  EmittedPhoton photon;
  double probability = 1;
  std::size_t light = source.light;
  switch (source.kind) {
    case StratumSource::Kind::sun:
      photon = ivory::emit(std::get<DirectionalLight>(scene.lights[source.light]), from.discs, source.disc,
                           sample_disc_compact(place));
      probability = double(from.picks.probability[source.light]);
      break;
    case StratumSource::Kind::sky:
      photon =
          ivory::emit(*state.environment, strata.sky, direction, from.discs, source.disc, sample_disc_compact(place));
      light = state.environment_index();
      probability = double(from.picks.probability[light]);
      break;
    case StratumSource::Kind::lamps:
    case StratumSource::Kind::emitters: {
      const Inverse which = source.last - source.first > 1
                                ? invert(strata.before, source.first, source.last, at.u[axis_which])
                                : Inverse{source.first, at.u[axis_which]};
      light = strata.members[which.index];
      probability = double(from.picks.probability[light]);
      if (source.kind == StratumSource::Kind::lamps) {
        photon = ivory::emit(scene.lights[light], direction);
        break;
      }
      const Emitter& emitter = state.emitters[light - state.punctual_count()];
      if (emitter.light != no_index) {
        photon = ivory::emit(scene, state.triangles[std::size_t(emitter.light)], place, direction, random);
        break;
      }
      const InstancedEmitter& mesh = state.instanced_of(emitter.instance);
      const std::vector<double>& before = strata.instanced.at(&mesh);
      const std::size_t entry = invert(before, 0, before.size() - 1, which.rest).index;
      const TriangleLight triangle =
          make_triangle_light(scene, *mesh.emission, emitter.instance, mesh.triangles[entry]);
      photon = ivory::emit(scene, triangle, place, direction, random);
      probability *= double(mesh.probability[entry]);
      break;
    }
  }
  photon.power *= float(1 / (probability * at.density));
  photon.light = int(light);
  return photon;
}

}  // namespace ivory
