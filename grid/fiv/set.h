// An occluder that turns: tables of one mesh, each turned about +Y by so much more than the one before.
//
// A table belongs to its environment: it holds which part of that light is hidden, so the mesh cannot be turned in it
// by turning vectors. What is the same is the mesh turned by R under the environment L, and the mesh as it was under L
// turned by R^-1. So where environment and occluders turn about +Y alone, a row of tables over their turn against each
// other holds all there is; between two of them both are read, each where its own silhouettes hide the light, and
// mixed.
#pragma once

#include <optional>
#include <vector>

#include "grid/fiv/light.h"

namespace ivory {

struct FivSet {
  // Never empty. Table k is of the mesh turned by k / N of a whole turn about +Y, about the centre of its bounding
  // sphere, counter-clockwise seen from above; all of one size, and shape and sphere are those of the mesh unturned.
  std::vector<FivTable> turns;
};

// Which two tables of a set of `count` to read for a mesh turned by turn_rad against its environment, and the second's
// share. Nothing where it is turned, by more than a ten thousandth, and there is one table alone.
struct FivBlend {
  int first = 0;
  int second = 0;
  float share = 0;
};
std::optional<FivBlend> blend_of_turn(int count, double turn_rad);

// An occluder of the set where it stands, turned so against its environment; nothing as blend_of_turn(). `at` says
// where (find_placement()). `set` must outlive it.
std::optional<FivPlacement> turned_placement(const FivSet& set, const FivPlacement& at, double turn_rad);

}  // namespace ivory
