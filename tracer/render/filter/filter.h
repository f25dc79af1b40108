// A filter for the noise that is left, guided by what the eye's rays first hit: albedo, normal and depth, which have
// hardly any noise. It is biased, and measures by how much.
//
// Non-local means with features, after F. Rousselle, C. Knaus, M. Zwicker, "Adaptive rendering with non-local means
// filtering", 2012, and F. Rousselle, M. Manzi, M. Zwicker, "Robust denoising using feature and color information",
// 2013. Light is divided by albedo, so that textures are left alone. A pixel becomes a weighted mean over those around
// it that are like it: by the light of small patches around both, as far as noise tells them apart, and by their first
// hits. Weights made of one half's light serve the other, as noise must not choose what it is averaged with.
//
// Several filters are tried, among them none, and each pixel takes what the halves say is best about it. With A and B
// the halves, F_A and F_B them filtered, the squared error of (F_A + F_B)/2 is estimated by
//
//   e = [(F_A - B)^2 + (F_B - A)^2]/2 - (A - B)^2/2 - (F_A - F_B)^2/4:
//
// F_A is compared with what it is not made of, whose variance is taken off; the last term is what the mean of the two
// is better than each. Its mean is bias and variance both. For F = A it is (A - B)^2/4. That holds where what is done
// to A at a pixel knows nothing of B there: neither do weights, nor does the choice.
#pragma once

#include "tracer/core/film_sums.h"

namespace ivory {

struct FilterParams {
  int radius = 7;  // pixels, of the square that is averaged over
  int threads = 0;
};

struct FilteredFilm {
  Film film;
  // Root of the mean of e, luminance ÷ mean luminance, of the filtered and the unfiltered picture. Noise and bias.
  double error = 0;
  double high = 0;  // with two standard errors more, by how much blocks of the picture differ
  double unfiltered_error = 0;
  double filtered_share = 0;  // of pixels that are not left as they were
};

// Of sums with two halves and first hits. Where the estimate says that the picture as a whole would be worse for it, it
// is left as it is (filtered_share 0). Same bits at any number of threads.
FilteredFilm filter_film(const FilmSums& sums, const FilterParams& params);

}  // namespace ivory
