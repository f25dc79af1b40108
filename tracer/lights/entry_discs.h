// Where light from afar, suns and the sky, enters a scene: through discs that face the way it comes from.
#pragma once

#include <optional>
#include <vector>

#include "tracer/core/intersector.h"
#include "tracer/core/sampler.h"
#include "tracer/core/sampling.h"

namespace ivory {

struct BoundingSphere {
  V3f center;
  float radius_m = 1;
};

// Where photons are asked for. It changes how many of them come near and what each of them carries, and no mean.
struct EmissionTarget {
  V3f center;           // of a sphere around it, world
  float radius_m = 0;   // above 0
  bool direct = false;  // photons count before they meet a surface, and so where there is none
};

// One disc over the scene's sphere; with a target that asks for them, smaller ones about the target as well.
struct EntryDiscs {
  BoundingSphere scene;
  // Below: of the target's discs alone.
  Box3f box;                    // around the scene's surfaces, and a little more
  V3d target{0, 0, 0};          // their common centre
  std::vector<double> radii_m;  // ascending; empty: there are none
  std::vector<double> shares;   // of the photons, for each of them; the scene's disc has the rest
  bool beyond_scene = false;    // photons that miss the scene's sphere carry light, too
};

// No smaller discs without a target, and for one about as large as the scene and inside its sphere. `box` are
// the scene's bounds.
EntryDiscs make_entry_discs(const BoundingSphere& scene, const Box3f& box, const std::optional<EmissionTarget>& target);

// A ray's start, ahead of all surfaces and of the target, and the area in m^2 that it stands for: 1 / pdf, 0 where it
// would only miss everything.
struct Entry {
  V3f origin;
  float area_m2 = 0;
};
// For light from w, a unit vector; frame.x and frame.y are at right angles to it.
Entry sample(const EntryDiscs& discs, const V3f& w, const ShadingFrame& frame, RandomStream& random);

// The same piece by piece: the discs, ascending, the scene's the last, with their shares of the photons, and a point of
// one of them, of the unit disc.
std::vector<double> disc_shares(const EntryDiscs& discs);
Entry enter(const EntryDiscs& discs, std::size_t disc, const Imath::V2d& point, const V3f& w,
            const ShadingFrame& frame);

// The area that a photon stands for where all discs overlap, on the target, and the largest that any stands for. Both
// are pi R^2 where there is one disc.
float near_area_m2(const EntryDiscs& discs);
float far_area_m2(const EntryDiscs& discs);

}  // namespace ivory
