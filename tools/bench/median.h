// The middle of repeated measurements.
#pragma once

#include <algorithm>
#include <vector>

namespace ivory {

// The upper of the two middle ones where their number is even; there must be at least one.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace ivory
