// How noisy is a picture, and where should more samples go?
//
// A pixel's samples are two halves A and B with independent random numbers. However they are spread over its area and
// its lights, (A - B)/2 has the variance of the error of (A + B)/2. One such number says little about one pixel, but
// their mean square over the picture is its squared error to a few per cent.
//
// For the least mean square error at a given number of samples, those of a pixel go as the standard deviation of one of
// its samples (Neyman 1934). What its halves say of that must not decide: a pixel whose number of samples hangs on its
// own values ends where these happen to agree, is off in the mean (Kirk & Arvo, "Unbiased sampling techniques for image
// synthesis", 1991), and has a larger error than it states. So the up to 24 pixels around it decide, and a pixel that
// has missed what they found does not end early. It still has a say in theirs; what is left of the bias is measured in
// a test.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "tracer/core/film_sums.h"

namespace ivory {

struct AdaptiveParams {
  // NoiseError::pixel to reach, its standard error added: who stops at the first estimate that is low enough stops at
  // one that is too low. 0: none, as far as the bounds allow.
  double target = 0;
  int max_samples = 16384;                                       // of one pixel
  double max_seconds = std::numeric_limits<double>::infinity();  // wall time; the first round is always finished
};

inline constexpr int least_samples = 16;  // a pixel; of an adaptive picture

// Of the noise in means over both halves, each of which has samples in every pixel. 0 for a black picture.
NoiseError measure_noise(const FilmSums& sums);

// Samples of each half that a next round should bring every pixel to (at least what it has) so that `target` is reached
// with few, but not more than twice those of the picture, nor four times those of a pixel; `most_new` bounds what is
// added to the picture, both halves together, about. Empty where nothing can be added or there is no noise.
std::vector<std::uint32_t> plan_round(const FilmSums& sums, const AdaptiveParams& params,
                                      double most_new = std::numeric_limits<double>::infinity());

}  // namespace ivory
