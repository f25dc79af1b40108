// Weighted means over pixels that are like each other, by several rules: what the filter chooses from.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tracer/core/film_sums.h"

namespace ivory {

struct Candidate {
  float color_scale;  // k: how far light may differ, in standard deviations of its noise; 0: whatever it does
  int radius;         // at most that of the parameters
};
constexpr std::array candidates{Candidate{0.5F, 99}, Candidate{1, 99}, Candidate{0, 99}, Candidate{0, 2}};
// Light of both halves, top row first.
using LightHalves = std::array<std::vector<Rgb>, 2>;

struct GuidedMeans {
  std::array<LightHalves, candidates.size()> light;  // nits
  // Something that shines by itself is seen in the pixel: at a lamp's edge noise is of its outline, and no other pixel
  // knows that. Left as it is, and averaged into none.
  std::vector<bool> shines;
};

// Of sums with two halves and first hits. What becomes of a pixel's half does not hang on the other half there, but for
// the estimate of noise around it. Same bits at any number of threads (0: as many as TBB gives).
GuidedMeans guided_means(const FilmSums& sums, int radius, int threads);

}  // namespace ivory
