// The light of an environment at a receiver among moving occluders, from their FIV tables.
#pragma once

#include <span>

#include "grid/fiv_table.h"

namespace ivory {

// An occluder where it stands: moved and evenly scaled, not turned, because a table belongs to its environment.
struct FivPlacement {
  const FivTable* table = nullptr;
  V3f center_m{0, 0, 0};  // of the bounding sphere, in the world
  float radius_m = 1;
};

// How light that several occluders hide is counted once.
enum class FivOverlap {
  none,     // each hides its own: too dark where shadows meet
  discs,    // the paper's eq. 13 and 14: overlapping bounding discs, pair by pair
  covers,   // each hides what the ones before left open: by common discs for spread light, by the mean directions of
            // what they hide for gathered light
  product,  // visible shares multiply, whatever the directions
};

struct FivLightParams {
  Straddling straddling = Straddling::bound;
  FivOverlap overlap = FivOverlap::covers;
};

// Irradiance in lux at p with unit normal n: `unshadowed`, the irradiance that the environment alone gives
// for n, less what the occluders hide (eq. 11). `self` is the index of the occluder that p lies on, or -1: it leaves
// n.(FIV_tot - FIV) (eq. 12). Never negative, and never more than the unshadowed light, or than what `self` leaves.
Rgb fiv_irradiance(std::span<const FivPlacement> occluders, const V3f& p, const V3f& n, int self, const Rgb& unshadowed,
                   const FivLightParams& params);

}  // namespace ivory
