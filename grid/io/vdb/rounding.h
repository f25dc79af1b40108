// What of a grid's numbers is worth its bits in a file: noise need not be kept to seven digits.
#pragma once

#include <span>
#include <vector>

#include "grid/field/irradiance_grid.h"

namespace ivory {

// Moments of some vertices, [vertex][function][rgb], each channel's rounded to the largest power of two that is no more
// than a quarter of the standard error that its vertex states for E. Errors of rounding are even within half of that
// step and independent of each other: they add less than one part in a hundred to the variance of E. What states no
// error (variance 0) is kept to the bit. `variance` has one entry a vertex, lux^2.
std::vector<float> rounded_to_noise(std::span<const float> moments, std::span<const Rgb> variance);

// Variances to seven significant bits, an error of 0.8 % at most: photons tell them to several per cent.
Rgb rounded_variance(const Rgb& variance);

// Are halves enough to store these numbers: is each within their range, and are all but one in a hundred exactly a half
// (what is not is then rounded by one part in 4,096)?
class HalfCheck {
 public:
  void add(float x);
  bool is_enough() const { return !beyond_ && 100 * inexact_ <= count_; }

 private:
  std::size_t count_ = 0;
  std::size_t inexact_ = 0;
  bool beyond_ = false;
};

}  // namespace ivory
