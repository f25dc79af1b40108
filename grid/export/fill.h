// What probes that know no light are given, so that readers without a guard show neither seams nor leaks beside walls.
//
// Such a reader mixes the eight probes around a point, and beside a wall some of them stand in it or behind it. A
// surface there faces the room that it belongs to. So what a probe in the wall is given differs by direction: E(n) is
// that of neighbours towards which n points, with weights of (cosine / distance)^2. A slab between a lit room and a
// dark one has a lit upper and a dark lower side, and neither leaks.
//
// Where neighbours in front of a side belong to different rooms - parted by planes of the guard, or no step of one
// probe joins them - the rooms' means are mixed with weights of 1 / E^2: nearly the darker one's, as light in a dark
// room is seen more easily than a lit one's seam. Probes that are unlit are no witnesses, as in look-ups
// (grid/field/yield.h).
#pragma once

#include <span>

#include "grid/export/probe_volume.h"

namespace ivory {

// Fills probes of state `dark` that have a measured neighbour among the 26 around them; sides without such a neighbour
// in front stay dark, but for probes in the volume's outermost layer, behind which there is no other room: they have
// the plain mean. Measured ones of less than full trust are mixed with neighbours that they see. Nine coefficients,
// where the volume has them, are those that have E of the six sides and no more. `guard` is [probe], or empty: nothing
// is known of walls.
void fill_unknown(ProbeVolume& volume, std::span<const GuardRecord> guard);

// The coefficients that give E of the six sides.
ProbeSh9 sh9_of_sides(const SixSides& sides);

}  // namespace ivory
