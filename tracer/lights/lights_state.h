// What Lights and its emissions are made of. Private to tracer/lights.
#pragma once

#include <vector>

#include "tracer/core/alias_table.h"
#include "tracer/lights/environment.h"
#include "tracer/lights/guide.h"
#include "tracer/lights/instanced_emitter.h"
#include "tracer/lights/lights.h"
#include "tracer/lights/strata.h"
#include "tracer/lights/triangle.h"

namespace ivory {

// A light of the table other than a punctual one or the environment.
struct Emitter {
  int instance;
  int light;  // among the triangles; no_index: the instance as a whole
};

struct Picks {
  AliasTable table;
  std::vector<float> probability;  // of picking each light
};

struct Lights::Emission::State {
  EntryDiscs discs;
  Picks picks;
  PhotonPower photon_power;
  // Of guided emissions; null and empty for others.
  std::shared_ptr<const Strata> strata;
  EmissionGuide guide;
};

// Lights are numbered punctual first, then emitters by instance, then the environment.
struct Lights::State {
  const Scene* scene = nullptr;
  BoundingSphere sphere;
  std::vector<std::unique_ptr<const MeshEmission>> emissions;      // [mesh]; null for dark ones
  std::vector<std::unique_ptr<const InstancedEmitter>> instanced;  // [mesh]; null for those not in such numbers
  std::vector<Emitter> emitters;
  std::vector<TriangleLight> triangles;
  std::vector<std::vector<int>> triangle_index;  // [instance][triangle] -> emitters; empty for dark or whole instances
  std::vector<int> instance_index;               // [instance] -> emitters, of whole instances, else no_index
  std::optional<EnvironmentLight> environment;
  Emission everywhere;  // without a target; its picks are sample()'s, too
  LightChoice choice;   // sample()'s for a receiver
  Rgb total_power{0, 0, 0};

  const Picks& picks() const { return everywhere.state_->picks; }
  std::size_t punctual_count() const { return scene->lights.size(); }
  std::size_t environment_index() const { return punctual_count() + emitters.size(); }

  const InstancedEmitter& instanced_of(int instance) const {
    return *instanced[std::size_t(scene->instances[std::size_t(instance)].mesh)];
  }

  Rgb power_of(const Emitter& emitter) const {
    if (emitter.light == no_index) return power_lm(*scene, instanced_of(emitter.instance), emitter.instance);
    return power_lm(triangles[std::size_t(emitter.light)]);
  }

  void add_emitters();
  LightChoice make_choice() const;
  // The light of a hit on an emissive triangle, among all; nothing for others.
  std::optional<std::uint32_t> light_at(const Hit& hit) const;
};

}  // namespace ivory
