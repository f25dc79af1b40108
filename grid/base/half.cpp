#include "grid/base/half.h"

#include <algorithm>
#include <cmath>

#include <half.h>

namespace ivory {

float rounded_to_half(float x) { return float(Imath::half(x)); }

float half_scale(float largest) {
  if (!(largest > 0)) return 1;
  return std::ldexp(1.0F, std::clamp(std::ilogb(largest) - 14, -100, 100));
}

}  // namespace ivory
