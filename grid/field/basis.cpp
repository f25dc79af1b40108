#include "grid/field/basis.h"

#include <algorithm>
#include <string>

#include "grid/base/error.h"
#include "grid/field/kernels.h"

namespace ivory {
namespace {

constexpr float sgn(float x) { return x < 0 ? -1.0F : 1.0F; }

kernels::Triple<float> triple(const V3f& v) { return {v.x, v.y, v.z}; }

// The value of each colour channel's moments.
template <typename Value>
Rgb of_channels(const float* m, const Value& value) {
  return {value(kernels::Channel<float>{m}), value(kernels::Channel<float>{m + 1}),
          value(kernels::Channel<float>{m + 2})};
}

Rgb irradiance_sh(const float* m, const V3f& n, unsigned count) {
  const auto of_normal = kernels::irradiance_harmonics(triple(n));
  return of_channels(m, [&](const auto& channel) { return kernels::irradiance_sh(channel, of_normal, count); });
}

Rgb load(const float* m) { return {m[0], m[1], m[2]}; }

// n.v for a vector stored as [xyz][rgb].
Rgb dot(const V3f& n, const float* v) { return load(v) * n.x + load(v + 3) * n.y + load(v + 6) * n.z; }

Rgb positive(const Rgb& value) { return {std::max(0.0F, value.x), std::max(0.0F, value.y), std::max(0.0F, value.z)}; }

// I_{+i} or I_{-i} (sign) as [xyz][rgb] dotted with n.
Rgb dot_hemisphere(const float* m, unsigned axis, float sign, const V3f& n) {
  return (dot(n, m) + dot(n, m + 9 * (axis + 1)) * sign) * 0.5F;
}

Rgb paper_vectors(const float* m, const V3f& n) {
  Rgb sum(0, 0, 0);
  for (unsigned i = 0; i < 3; ++i) sum += dot_hemisphere(m, i, sgn(n[i]), n) * (n[i] * n[i]);
  return positive(sum);
}

}  // namespace

int function_count(Basis basis) {
  switch (basis) {
    case Basis::vectors:
      return 12;
    case Basis::vectors9:
    case Basis::sh9:
      return 9;
    case Basis::ambient_cube:
      return 6;
    case Basis::sh4:
      return 4;
  }
  return 0;
}

std::array<float, max_functions> eval(Basis basis, const V3f& w) {
  const float sx = sgn(w.x);
  const float sy = sgn(w.y);
  const float sz = sgn(w.z);
  switch (basis) {
    case Basis::vectors:
      return {w.x,      w.y,      w.z,       // F
              sx * w.x, sx * w.y, sx * w.z,  // D_x
              sy * w.x, sy * w.y, sy * w.z,  // D_y
              sz * w.x, sz * w.y, sz * w.z};
    case Basis::vectors9:
      return {
          w.x, w.y, w.z, sx * w.x, sy * w.y, sz * w.z, sx * w.y + sy * w.x, sx * w.z + sz * w.x, sy * w.z + sz * w.y};
    case Basis::ambient_cube:
      return {std::max(0.0F, w.x),  std::max(0.0F, -w.x), std::max(0.0F, w.y),
              std::max(0.0F, -w.y), std::max(0.0F, w.z),  std::max(0.0F, -w.z)};
    case Basis::sh9:
    case Basis::sh4:
      break;
  }
  std::array<float, max_functions> out{};
  const auto y = kernels::harmonics(triple(w));
  std::copy_n(y.begin(), function_count(basis), out.begin());
  return out;
}

Rgb irradiance(Basis basis, Reconstruction reconstruction, const float* m, const V3f& n) {
  if (reconstruction == Reconstruction::paper) {
    if (!reads(reconstruction, basis)) throw ParameterError("reconstruction", "paper reads the basis vectors only");
    return paper_vectors(m, n);
  }
  const auto normal = triple(n);
  switch (basis) {
    case Basis::vectors: {
      const auto even = kernels::even_coefficients(normal);
      return of_channels(m, [&](const auto& channel) { return kernels::optimal_vectors(channel, normal, even); });
    }
    case Basis::vectors9: {
      const auto even = kernels::even_coefficients(normal);
      return of_channels(m, [&](const auto& channel) { return kernels::optimal_vectors9(channel, normal, even); });
    }
    case Basis::sh9:
      return irradiance_sh(m, n, 9);
    case Basis::ambient_cube:
      return of_channels(m, [&](const auto& channel) { return kernels::irradiance_ambient_cube(channel, normal); });
    case Basis::sh4:
      return irradiance_sh(m, n, 4);
  }
  return {0, 0, 0};
}

IrradianceBracket irradiance_bracket(const float* m, const V3f& n) {
  IrradianceBracket out;
  for (unsigned c = 0; c < 3; ++c) {
    const kernels::Bracket<float> bounds = kernels::bracket(kernels::Channel<float>{m + c}, triple(n));
    out.lower[c] = bounds.lower;
    out.upper[c] = bounds.upper;
  }
  return out;
}

std::array<float, 54> hemispheres_from_moments(std::span<const float, 36> m) {
  std::array<float, 54> out{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < 9; ++i) {
      out[18 * axis + i] = (m[i] + m[9 * (axis + 1) + i]) * 0.5F;
      out[18 * axis + 9 + i] = (m[i] - m[9 * (axis + 1) + i]) * 0.5F;
    }
  }
  return out;
}

std::array<float, 36> moments_from_hemispheres(std::span<const float, 54> h) {
  std::array<float, 36> out{};
  for (std::size_t i = 0; i < 9; ++i) {
    // The three axes carry the same F; their mean has the least rounding.
    out[i] = (h[i] + h[9 + i] + h[18 + i] + h[27 + i] + h[36 + i] + h[45 + i]) / 3;
    for (std::size_t axis = 0; axis < 3; ++axis) out[9 * (axis + 1) + i] = h[18 * axis + i] - h[18 * axis + 9 + i];
  }
  return out;
}

}  // namespace ivory
