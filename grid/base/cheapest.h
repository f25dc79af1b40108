// The cheapest of a row of settings that meets an error.
#pragma once

#include <cmath>
#include <span>

#include "grid/base/measured_error.h"

namespace ivory {

struct CheapestSetting {
  int value = 0;
  MeasuredError predicted;  // what it was judged by
  bool met = false;
};

// The first of `ladder` (ascending, not empty) whose error by `judge(value)` meets `target` with its whole interval,
// and then, `refinements` times, halfway (in the ratio) between it and the one before: the cheapest of those that were
// looked at. Where none meets it, the one whose interval ends lowest. As each choice depends on `target` by comparison
// alone, a tighter target never gives a smaller value.
template <typename Judge>
CheapestSetting cheapest_setting(std::span<const int> ladder, int refinements, double target, const Judge& judge) {
  CheapestSetting best;
  int below = 0;  // the largest before it, found wanting
  bool first = true;
  for (const int value : ladder) {
    const MeasuredError error = judge(value);
    const bool met = error.high <= target;
    if (first || met || error.high < best.predicted.high) best = {value, error, met};
    if (met) break;
    below = value;
    first = false;
  }
  if (!best.met || below == 0) return best;
  for (int i = 0; i < refinements; ++i) {
    const int middle = int(std::lround(std::sqrt(double(below) * double(best.value))));
    if (middle <= below || middle >= best.value) break;
    const MeasuredError error = judge(middle);
    if (error.high <= target) {
      best = {middle, error, true};
    } else {
      below = middle;
    }
  }
  return best;
}

}  // namespace ivory
