// Photons from the lights through the scene, as straight segments with the power they carry.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "grid/field/irradiance_grid.h"
#include "tracer/core/lit_scene.h"
#include "tracer/core/plain_surfaces.h"
#include "tracer/render/photons/aim.h"
#include "tracer/render/photons/window.h"

namespace ivory {

struct PhotonSegment {
  V3f origin;
  V3f direction;         // unit, the way the photon flies; the light arrives from w = -direction
  float length_m = 0;    // infinity where it leaves the scene
  Rgb power_lm;          // per photon: divide by the number of photons traced
  float jitter = 0;      // uniform in [0, 1), for whoever samples positions along the segment
  int light = no_index;  // whose light it is: Lights::count()
};

// A photon that meets a surface.
struct PhotonArrival {
  V3f p;
  V3f n;         // unit geometric normal, on the side that the photon came from
  Rgb power_lm;  // per photon: divide by the number of photons traced
};

struct PhotonParams {
  int max_bounces = 1000;             // Russian roulette ends paths long before; this bounds the time in a mirror box
  DirectSources include_direct = {};  // also segments and arrivals that come straight from these; true: from all
  std::uint64_t seed = 1;
  std::optional<EmissionTarget> target = std::nullopt;      // where they are asked for; none: everywhere
  std::optional<Lights::Emission> emission = std::nullopt;  // how they are sent; none: by `target`
  std::shared_ptr<const PhotonWindow> window = nullptr;     // what they should carry; null: whatever they do
  std::optional<PhotonAim> aim = std::nullopt;              // where to scatter to; none: nowhere in particular
  StreamPurpose purpose = StreamPurpose::photon;            // whose random numbers they are made of
};

// Where the power went, per photon traced, in units of `unit_lm` summed over rgb. Integers, so that
// ranges of photons add up exactly: emitted == absorbed + escaped + terminated, to the unit. What Russian roulette ends
// is absorbed; what a PhotonWindow's lot ends is, too, and what it adds to survivors is taken off it: each is right in
// the mean, and pieces of a split photon share its units.
struct PhotonLedger {
  std::int64_t emitted = 0;
  std::int64_t absorbed = 0;
  std::int64_t escaped = 0;
  std::int64_t terminated = 0;  // still under way at max_bounces
  std::int64_t photons = 0;
  std::int64_t rays = 0;  // closest-hit queries, the first segment of each photon included
  PhotonLedger& operator+=(const PhotonLedger& other);
};

class PhotonTracer {
 public:
  // `lit` must outlive this object.
  PhotonTracer(const LitScene& lit, const PhotonParams& params);

  // Traces photons [begin, end) and appends their segments, photon by photon.
  void trace(std::uint64_t begin, std::uint64_t end, std::vector<PhotonSegment>& segments, PhotonLedger& ledger) const;

  // The same photons; appends where they meet surfaces that have a diffuse lobe, photon by photon.
  void trace_arrivals(std::uint64_t begin, std::uint64_t end, std::vector<PhotonArrival>& arrivals,
                      PhotonLedger& ledger) const;

  // Lumen that one unit of a PhotonLedger stands for.
  double ledger_unit_lm() const { return ledger_unit_lm_; }

  const Lights::Emission& emission() const { return emission_; }

 private:
  // Calls segment(ray, hit, power, jitter, light) for each segment and arrival(surface, power) where one ends at a
  // surface.
  template <bool arrivals_asked, typename OnSegment, typename OnArrival>
  void trace_paths(std::uint64_t begin, std::uint64_t end, PhotonLedger& ledger, const OnSegment& segment,
                   const OnArrival& arrival) const;

  const LitScene& lit_;
  PhotonParams params_;
  Lights::Emission emission_;
  double ledger_unit_lm_;
  PlainSurfaces surfaces_;
};

}  // namespace ivory
