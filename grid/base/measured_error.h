// How far an asset is from the truth, from points that know it, each with noise of its own.
#pragma once

#include <span>

namespace ivory {

// At one point, drawn independently of the others. With two independent estimates a and b of the truth t, (x - a)(x -
// b) is such an estimate of (x - t)^2: it has no bias, and is negative now and then.
struct PointError {
  double squared = 0;  // estimate of the squared error
  double truth = 0;    // estimate of what the error is a share of
  double weight = 1;
};

// Shares: 0.02 is 2 %.
struct MeasuredError {
  double error = 0;
  double low = 0;  // 95 % confidence interval; error lies within
  double high = 0;
  double square_standard_error = 0;  // of error^2
};

// Root of the mean squared error over the mean truth, which is not negative. Without any truth the error is 0 where
// there is none at any point, and else infinite. 0 for no points.
MeasuredError root_mean_square(std::span<const PointError> points);

// Mean of errors that are shares already.
MeasuredError mean_error(std::span<const double> errors);

}  // namespace ivory
