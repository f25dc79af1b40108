// A weighted root mean square over a mean, from samples of both, with its confidence interval.
#pragma once

#include <vector>

#include "grid/base/types.h"

namespace ivory {

struct ErrorSample {
  double weight = 1;
  double square = 0;  // unbiased estimate of the squared error at a point; may be below 0
  double value = 0;   // what the error is taken relative to, at that point
};

struct ErrorInterval {
  double error = 0;  // root of the mean square ÷ mean value; 0 where the mean square came out below 0
  double low = 0;    // 95 %
  double high = 0;
  double log_standard_error = 0;  // of `error`, as a share of it; infinite where nothing is known
};

// At least two samples, the mean of `value` above 0.
ErrorInterval root_mean_square(const std::vector<ErrorSample>& samples);

}  // namespace ivory
