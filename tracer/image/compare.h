// How far one picture is from another.
#pragma once

#include "tracer/core/film.h"

namespace ivory {

// Over all pixels and the three channels alike, of picture a and reference b.
struct ImageDifference {
  double nrmse =
      0;  // RMSE / (max - min of the reference); 0 where both are equal, infinite where only the reference is flat
  double relative_rmse = 0;  // root of mean((a - b)^2 / (b^2 + (0.01 mean b)^2))
  double rmse = 0;           // root of mean((a - b)^2)
  double max = 0;            // largest absolute difference
  double bias = 0;           // mean(a - b)
  double reference_mean = 0;

  // Standard errors of nrmse and relative_rmse as means over the picture, from blocks of 8x8 pixels taken as
  // independent. With s that of the mean square m: s / (2 sqrt(m)); where m is not above s/4, as may be with two
  // references, sqrt(s), the error at m = s: then the picture is at most about that far off, and nrmse, which may be 0,
  // is no measurement.
  double nrmse_standard_error = 0;
  double relative_rmse_standard_error = 0;
  // Of two references: the RMSE, in units of nrmse and relative_rmse, that the noise of their mean (b + c)/2 has, so
  // that a picture without any error would seem to have it if it were compared with that mean. nrmse and relative_rmse
  // are without it; it bounds neither. 0 with one reference, whose noise nothing tells.
  double reference_nrmse = 0;
  double reference_relative_rmse = 0;
};

// Both films have the same size, at least one pixel. The reference counts as truth: its noise is in all results, in
// relative_rmse by its weights as well.
ImageDifference compare_images(const Film& image, const Film& reference);

// With two references of independent noise, b and c, (a - b)(a - c) takes the place of (a - b)^2: its expectation is
// (a - truth)^2, without their noise. A mean below zero counts as zero. The truth elsewhere is (b + c)/2, in `max` and
// in the range under nrmse noise and all.
//
// relative_rmse divides by m^2 + (0.01 mean)^2, where m is the mean of (b + c)/2 over the up to 24 other pixels of the
// 5x5 around the pixel (its own value in a picture of one pixel). Its own value as divisor would be small just where
// (a - b)(a - c) is large: with independent noise of variance sigma^2 relative to the truth and a picture off by d of
// it, the square would be off by about 2 d sigma^2 + 3/2 sigma^4. Noise of m is worth 3/48 sigma^2 of the square.
// The references' noise has to be independent from pixel to pixel as well: neither is denoised or filtered.
ImageDifference compare_images(const Film& image, const Film& reference, const Film& second_reference);

}  // namespace ivory
