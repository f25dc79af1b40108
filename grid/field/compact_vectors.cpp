#include "grid/field/compact_vectors.h"

#include <cmath>

namespace ivory {

// With the norms a_c = |I_c| kept, the direction d that is best in the least-squares sense minimises
//   sum_c |I_c - a_c d|^2 = const - 2 d . sum_c a_c I_c   over |d| = 1,   so   d ~ sum_c |I_c| I_c.
// The paper takes the plain sum of the I_c, which on baked scenes comes within a few per cent of the same error.
std::array<float, 36> compact_from_moments(std::span<const float, 36> moments) {
  const std::array<float, 54> h = hemispheres_from_moments(moments);
  std::array<float, 36> out{};
  for (std::size_t hemisphere = 0; hemisphere < 6; ++hemisphere) {
    V3f direction(0, 0, 0);
    for (std::size_t c = 0; c < 3; ++c) {
      const float* v = h.data() + 9 * hemisphere + c;
      const V3f vector(v[0], v[3], v[6]);
      const float norm = vector.length();
      out[3 * hemisphere + c] = norm;
      direction += vector * norm;
    }
    direction.normalize();  // leaves zero as it is
    for (std::size_t i = 0; i < 3; ++i) out[18 + 3 * hemisphere + i] = direction[unsigned(i)];
  }
  return out;
}

std::array<float, 36> moments_from_compact(std::span<const float, 36> compact, const V3f& n) {
  std::array<float, 36> out{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t plus = 2 * axis;
    const std::size_t minus = plus + 1;
    const auto direction = [&](std::size_t hemisphere) {
      const float* d = compact.data() + 18 + 3 * hemisphere;
      return V3f(d[0], d[1], d[2]).normalized();
    };
    const V3f d_plus = direction(plus);
    const V3f d_minus = direction(minus);
    const float weight = n[unsigned(axis)] * n[unsigned(axis)];
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float i_plus = d_plus[unsigned(i)] * compact[3 * plus + c];
        const float i_minus = d_minus[unsigned(i)] * compact[3 * minus + c];
        out[3 * i + c] += weight * (i_plus + i_minus);
        out[9 * (axis + 1) + 3 * i + c] = i_plus - i_minus;
      }
    }
  }
  return out;
}

}  // namespace ivory
