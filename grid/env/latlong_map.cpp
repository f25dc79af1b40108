#include "grid/env/latlong_map.h"

#include <algorithm>
#include <cmath>

#include "grid/env/cube_from_latlong.h"

namespace ivory {

Rgb eval(const EnvironmentMap& environment, const V3f& w) {
  // atan2 for the polar angle too: acos(y) has no digits left near the poles.
  const float u = 0.5F + std::atan2(-w.x, w.z) / (2 * pi);
  const float v = std::atan2(std::sqrt(w.x * w.x + w.z * w.z), w.y) / pi;
  const int column = std::clamp(int(u * float(environment.width)), 0, environment.width - 1);
  const int row = std::clamp(int(v * float(environment.height)), 0, environment.height - 1);
  return environment.radiance[std::size_t(row) * std::size_t(environment.width) + std::size_t(column)];
}

CubeMap cube_from_environment(const EnvironmentMap& environment, int size) {
  return cube_from_latlong(environment.radiance, environment.width, environment.height, size);
}

}  // namespace ivory
