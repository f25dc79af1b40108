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
};

// Both films have the same size, at least one pixel.
ImageDifference compare_images(const Film& image, const Film& reference);

}  // namespace ivory
