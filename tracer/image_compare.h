// How far one picture is from another.
#pragma once

#include "tracer/film.h"

namespace ivory {

// All over pixels and the three channels alike.
struct ImageDifference {
  double nrmse =
      0;  // RMSE / (max - min of the reference); 0 where both are equal, infinite where only the reference is flat
  double relative_rmse = 0;  // root of mean((a - b)^2 / (b^2 + (0.01 mean b)^2))
  double rmse = 0;
  double max = 0;   // largest absolute difference
  double bias = 0;  // mean(a - b)
  double reference_mean = 0;

  // Standard errors of nrmse and relative_rmse as means over the picture, from blocks of 8x8 pixels taken as
  // independent.
  double nrmse_standard_error = 0;
  double relative_rmse_standard_error = 0;
  // What is left of the references' own noise in their mean, in units of nrmse and relative_rmse; 0 with one reference.
  double reference_nrmse = 0;
  double reference_relative_rmse = 0;
};

// Both films have the same size, at least one pixel.
ImageDifference compare_images(const Film& image, const Film& reference);

// With two references of independent noise, b and c, (a - b)(a - c) takes the place of (a - b)^2: its expectation is
// (a - truth)^2, without their noise. A mean below zero counts as zero. The truth elsewhere is (b + c)/2.
ImageDifference compare_images(const Film& image, const Film& reference, const Film& second_reference);

}  // namespace ivory
