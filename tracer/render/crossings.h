// A ray through surfaces of part coverage (BLEND, transmission): what it sees of each, instead of one met at random.
// Shared by the methods that trace rays.
#pragma once

#include <span>

#include "tracer/core/lit_scene.h"
#include "tracer/core/surface.h"

namespace ivory {

// With a_i the coverage of the surfaces that a ray crosses, nearest first, light that goes along it against its
// direction is
//
//   L = sum_i w_i L_i + w L_behind,    w_i = a_i prod_{j<i} (1 - a_j),    w = prod_j (1 - a_j),
//
// L_i what surface i sends towards the ray's origin. Up to the eight nearest are taken so, and the first whole surface
// behind them as the last; where more are crossed, one of those behind at random, as ray.coverage_seed decides.
struct Crossings {
  struct Seen {
    Hit hit;
    float weight = 0;  // w_i, above 0
  };
  std::array<Seen, Passage::most + 1> seen;  // the first `count`
  std::size_t count = 0;
  float beyond = 1;  // weight of the environment behind them all; 0 where a whole surface ends the ray
};
Crossings cross_surfaces(const LitScene& lit, const Ray& ray);

// The surfaces themselves, with what each sends on.
struct SeenSurfaces {
  std::array<Surface, Passage::most + 1> surfaces;  // the first `count`, nearest first
  std::array<float, Passage::most + 1> weights{};   // w_i
  std::size_t count = 0;

  void add(const Surface& surface, float weight) {
    surfaces[count] = surface;
    weights[count++] = weight;
  }
};

// Probabilities with which a path goes on from each: in proportion to weight and about what it reflects, above 0 where
// both are. All 0 where none reflects.
std::array<float, Passage::most + 1> going_on(const SeenSurfaces& seen);
// One of them by u uniform in [0, 1).
std::size_t choose(std::span<const float> probabilities, float u);

}  // namespace ivory
