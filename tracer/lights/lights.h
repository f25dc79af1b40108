// All that shines in a scene, under one interface: punctual lights, emissive triangles, the environment. Which of them
// sends a photon is decided half by power and half evenly; which is sampled for a surface, by what it may give there.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "tracer/core/intersector.h"
#include "tracer/core/sampler.h"
#include "tracer/lights/choice/choice.h"
#include "tracer/lights/entry_discs.h"
#include "tracer/lights/guide.h"

namespace ivory {

struct EmittedPhoton {
  V3f origin;            // world
  V3f direction;         // unit, the way the photon flies
  Rgb power;             // lumen carried, so that the mean over photons times 1 is the scene's total flux
  int light = no_index;  // that sent it, among all: see Lights::count()
};

struct LightSample {
  V3f w;                      // unit, towards the light
  float distance_m = 0;       // infinity for directional lights and the environment
  Rgb irradiance_weight;      // L / pdf_solid_angle, or I / r^2 / pick probability: times f cos gives radiance
  float pdf_solid_angle = 0;  // of this w among all non-delta lights, pick probability included; 0 for delta lights
  bool delta = false;
  // Where light at a finite distance comes from, for the end of a shadow ray: the point, the emitter's unit normal (0
  // for a light without a surface) and its triangle_reach_m().
  V3f point{0, 0, 0};
  V3f ng{0, 0, 0};
  float reach_m = 0;
};

// A piece of an emissive surface, for who draws it as a small light.
struct EmitterPoint {
  V3f p;                       // world
  V3f n;                       // unit normal of the side that shines
  float area_m2 = 0;           // of surface that it stands for
  Rgb radiance_nits{0, 0, 0};  // of that side, coverage included
  int instance = no_index;
};

class Lights {
 public:
  // Those of intersector.scene(), which must outlive this object. Throws Error where a light is not finite.
  explicit Lights(const Intersector& intersector);
  ~Lights();
  Lights(Lights&&) noexcept;
  Lights& operator=(Lights&&) noexcept;

  bool empty() const;  // nothing emits
  // Lights are numbered: punctual ones as in the scene, then emissive triangles and whole instances by instance, then
  // the environment.
  std::size_t count() const;
  // The scene's node that placed a light; no_index for the environment and in a scene without nodes.
  int node_of(std::size_t light) const;
  bool is_environment(std::size_t light) const;
  bool is_punctual(std::size_t light) const;
  bool has_extended() const;   // emissive triangles or an environment: light that rays can run into
  Rgb total_power_lm() const;  // per channel; directional and environment light enter through the
                               // disc over the scene's bounding sphere

  // Power (lm, strongest channel) that photons carry, of the groups of lights with the strongest and with the weakest
  // photons: what fixed-point sums are scaled by. A textured emitter's photons vary around it. Of suns and skies it is
  // that of photons on their way to the target of their emission; few come by way of what stands around it, and they
  // carry up to heaviest_lm.
  struct PhotonPower {
    float strongest_lm = 0;
    float weakest_lm = 0;
    float heaviest_lm = 0;
  };

  // How photons are sent out: how often each light is picked, and where light from afar enters.
  class Emission {
   public:
    PhotonPower photon_power() const;
    const EntryDiscs& discs() const;

    bool is_guided() const;
    // Of guidable ones: what the guide goes by, and the guide.
    const std::vector<GuideStratum>& strata() const;
    const EmissionGuide& guide() const;
    // The same by another guide of the same strata. `typical_lm`: power of most photons that count, which becomes the
    // strongest of photon_power(); 0: as without a guide.
    Emission guided(EmissionGuide guide, float typical_lm) const;

   private:
    friend class Lights;
    struct State;
    std::shared_ptr<const State> state_;
  };
  // For that target. Suns and skies are picked by the flux that they send at it, not by that for the whole scene.
  Emission emission(const std::optional<EmissionTarget>& target) const;

  // The same photons in the mean, made in a way that a guide can change; the guide that it has changes nothing.
  Emission guidable(const Emission& emission) const;

  // One photon. Its power is the light's flux over the probability that it is picked with; black where nothing shines.
  EmittedPhoton emit(const Emission& emission, RandomStream& random) const;
  // The same without a target, picked as in sample().
  EmittedPhoton emit(RandomStream& random) const;
  PhotonPower photon_power() const;

  // One light as seen from p, half by power and half evenly; nothing when that light cannot reach p
  // (behind an emitter's dark side, outside a spot's cone). Visibility is the caller's.
  std::optional<LightSample> sample(const V3f& p, RandomStream& random) const;

  // For the receiver, `samples(pick)` samples from different lights, whose sum is the estimate; sample i (below that)
  // of them, whose weight and density are those of that light alone. One among several lights is chosen by about what
  // it gives the receiver unshadowed, and a little by chance; nothing where none reaches it. Visibility is the
  // caller's.
  int samples(LightPick pick) const;
  std::optional<LightSample> sample(const Receiver& receiver, LightPick pick, int i, RandomStream& random) const;
  // Density (1/sr) of those samples, over all of them, in the direction of this hit on an emissive triangle; 0 for
  // triangles that do not emit.
  float pdf_solid_angle(const Receiver& receiver, const Hit& hit, LightPick pick) const;
  // The same for the environment in direction w.
  float environment_pdf_solid_angle(const Receiver& receiver, const V3f& w, LightPick pick) const;

  // Points of the emissive surfaces that stand for all of them, `count` or, where some shine with nothing, fewer; in
  // proportion to power within an instance, half by power and half evenly among instances, spread evenly.
  std::vector<EmitterPoint> emitter_points(std::size_t count, std::uint64_t seed) const;

  // pdf (1/sr) with which sample(p) would have chosen the direction of this hit on an emissive
  // triangle, pick probability included; 0 for triangles that do not emit.
  float pdf_solid_angle(const V3f& p, const Hit& hit) const;
  // The same for the environment in direction w, and its radiance in nits.
  float environment_pdf_solid_angle(const V3f& w) const;
  Rgb environment_radiance(const V3f& w) const;

 private:
  float pdf_of_point(const V3f& p, const Hit& hit) const;
  EmittedPhoton emit_guided(const Emission& emission, RandomStream& random) const;

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ivory
