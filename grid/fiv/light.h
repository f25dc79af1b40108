// The light of an environment at a receiver among moving occluders, from their FIV tables.
#pragma once

#include <limits>
#include <span>

#include "grid/fiv/table.h"

namespace ivory {

// An occluder where it stands: moved and evenly scaled. A table belongs to its environment, so what turns needs tables
// of its turns (grid/fiv/set.h).
struct FivPlacement {
  const FivTable* table = nullptr;
  V3f center_m{0, 0, 0};  // of the bounding sphere, in the world
  float radius_m = 1;
  // most_hidden(table), for leaving out what is too far to matter; infinite: never left out.
  float most_hidden = std::numeric_limits<float>::infinity();
  const FivTable* next = nullptr;  // of a mesh between two turns: the other table; null: there is one
  float next_share = 0;            // of what is read of both
};

// The most that the occluder can take from any receiver, as luminance of E over fiv_falloff() of the distance: no
// normal and no place between the samples takes more.
float most_hidden(const FivTable& table);

// How light that several occluders hide is counted once.
enum class FivOverlap {
  none,     // each hides its own: too dark where shadows meet
  discs,    // the paper's eq. 13 and 14: overlapping bounding discs, pair by pair; of the strongest alone
  covers,   // each hides what stronger ones left open: by common discs for spread light, by the mean directions of
            // what they hide for gathered light; weaker ones among themselves by product
  product,  // visible shares multiply, whatever the directions
};
template <>
inline constexpr auto name_table<FivOverlap> = make_name_table<FivOverlap>("overlap", {{FivOverlap::covers, "covers"},
                                                                                       {FivOverlap::discs, "discs"},
                                                                                       {FivOverlap::product, "product"},
                                                                                       {FivOverlap::none, "none"}});

// Shadows that are compared pair by pair, the strongest; so the cost is linear in the occluders.
inline constexpr int fiv_strongest = 8;

// Occluders are left out that cannot, all together, hide more than this share of the unshadowed light.
inline constexpr float fiv_negligible = 1e-3F;

struct FivLightParams {
  Straddling straddling = Straddling::bound;
  FivOverlap overlap = FivOverlap::covers;
};

// Irradiance in lux at p with unit normal n: `unshadowed`, the irradiance that the environment alone gives for n, less
// what the occluders hide (eq. 11). `self` is the index of the occluder that p lies on, or -1: it leaves n.(FIV_tot -
// FIV) (eq. 12). Never negative, and never more than the unshadowed light, or than what `self` leaves. Among more than
// fiv_strongest occluders the order has a small say: a shadow is compared with the strongest so far.
Rgb fiv_irradiance(std::span<const FivPlacement> occluders, const V3f& p, const V3f& n, int self, const Rgb& unshadowed,
                   const FivLightParams& params);

}  // namespace ivory
