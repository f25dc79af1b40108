// A photon map with precomputed irradiance: the rival that irradiance-vector grids are charted against.
// H. W. Jensen, "Global illumination using photon maps", 1996; P. H. Christensen, "Faster photon map global
// illumination", 1999.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "tracer/core/camera.h"
#include "tracer/core/lit_scene.h"

namespace ivory {

struct PhotonMapParams {
  std::uint64_t photons = 1'000'000;  // to send out from the lights; each is stored at every diffuse surface it meets
  int neighbours = 50;                // photons an estimate counts, at least 2
  int max_bounces = 1000;
  std::uint64_t seed = 1;
  int threads = 0;                                      // 0: as many as TBB gives
  std::optional<EmissionTarget> target = std::nullopt;  // where it will be read; none: everywhere
  std::function<void(std::uint64_t done, std::uint64_t total)>
      progress;  // photons, then estimates, each photon and each estimate one; from any thread, one at a time
};

// The sphere of twice the median distance of what the picture shows around its middle; nothing where it shows nothing.
std::optional<EmissionTarget> target_in_view(const Intersector& intersector, const View& view);

// Indirect light only. Bits do not depend on threads.
class PhotonMap {
 public:
  // Throws Error where nothing shines or where memory would not suffice.
  PhotonMap(const LitScene& lit, const PhotonMapParams& params);
  ~PhotonMap();
  PhotonMap(PhotonMap&&) noexcept;
  PhotonMap& operator=(PhotonMap&&) noexcept;

  // E in lux per channel at world point p on the side of unit n: that of the nearest estimate on a surface that faces
  // the same way; black where none is near.
  Rgb irradiance(const V3f& p, const V3f& n) const;

  std::size_t photons_stored() const;
  std::size_t estimates() const;  // points with a precomputed irradiance
  std::size_t bytes() const;      // of what irradiance() reads: estimates and their tree

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ivory
