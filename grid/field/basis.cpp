#include "grid/field/basis.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "grid/base/error.h"

namespace ivory {
namespace {

constexpr float sgn(float x) { return x < 0 ? -1.0F : 1.0F; }

Rgb load(const float* m) { return {m[0], m[1], m[2]}; }

// n.v for a vector stored as [xyz][rgb].
Rgb dot(const V3f& n, const float* v) { return load(v) * n.x + load(v + 3) * n.y + load(v + 6) * n.z; }

Rgb clamp_to(const Rgb& value, const Rgb& lower, const Rgb& upper) {
  Rgb out;
  for (unsigned c = 0; c < 3; ++c) out[c] = std::min(std::max(value[c], lower[c]), std::max(lower[c], upper[c]));
  return out;
}

Rgb positive(const Rgb& value) { return {std::max(0.0F, value.x), std::max(0.0F, value.y), std::max(0.0F, value.z)}; }

// --- vectors ------------------------------------------------------------------------------------
//
// E(n) = int L max(0, n.w) dw = 1/2 n.F + 1/2 int L |n.w| dw. With F the odd half is exact. The even half asks for
// |n.w| in terms of what the moments D_i = I_{+i} - I_{-i} = int L sgn(w_i) w dw hold:
//
//   |n.w| ~ sum_i a_i |w_i| + sum_{i != j} b_ij sgn(w_i) w_j.
//
// Least squares over the sphere. Parity leaves two kinds of blocks in the Gram matrix, p = int w_i^2 = 4 pi/3 on and q
// = int |w_i w_j| = 8/3 off the diagonal: {|w_x|, |w_y|, |w_z|}, and {sgn(w_i) w_j, sgn(w_j) w_i} for each pair. The
// right sides follow from
//
//   K(a, n) = int |a.w||n.w| dw = 8/3 (sqrt(|a|^2 |n|^2 - (a.n)^2) + (a.n) asin(a.n / |a||n|)):
//   int |w_i||n.w|       = K(e_i, n)           = 8/3 (sqrt(1 - n_i^2) + n_i asin n_i),
//   int sgn(w_i) w_j |n.w| = dK/da_j at a = e_i = 8/3 n_j asin n_i.
//
// Uniform light is made exact by the constraint sum a_i = 1 (int |w_i| = int |n.w| = 2 pi); by the block's symmetry its
// Lagrange multiplier adds the same amount to each a_i.
constexpr float gram_p = 4 * pi / 3;
constexpr float gram_q = 8.0F / 3;

struct EvenCoefficients {
  std::array<std::array<float, 3>, 3> c;  // c[i][i] = a_i, c[i][j] = b_ij
};

EvenCoefficients even_coefficients(const V3f& n) {
  std::array<float, 3> angle{};
  std::array<float, 3> rhs{};
  for (unsigned i = 0; i < 3; ++i) {
    const float ni = std::clamp(n[i], -1.0F, 1.0F);
    angle[i] = std::asin(ni);
    rhs[i] = gram_q * (std::sqrt(1 - ni * ni) + ni * angle[i]);
  }
  // (p - q) I + q 1 1^T has the inverse (I - q/(p + 2q) 1 1^T) / (p - q); the constraint then replaces the common part
  // by what makes the sum one.
  constexpr float spread = 1 / (gram_p - gram_q);
  const float mean = (rhs[0] + rhs[1] + rhs[2]) / 3;
  EvenCoefficients out{};
  for (unsigned i = 0; i < 3; ++i) out.c[i][i] = (rhs[i] - mean) * spread + 1.0F / 3;
  constexpr float scale = gram_q / (gram_p * gram_p - gram_q * gram_q);
  for (unsigned i = 0; i < 3; ++i) {
    for (unsigned j = 0; j < 3; ++j) {
      if (i != j) out.c[i][j] = scale * (gram_p * n[j] * angle[i] - gram_q * n[i] * angle[j]);
    }
  }
  return out;
}

// I_{+i} or I_{-i} (sign) as [xyz][rgb] dotted with n.
Rgb dot_hemisphere(const float* m, unsigned axis, float sign, const V3f& n) {
  return (dot(n, m) + dot(n, m + 9 * (axis + 1)) * sign) * 0.5F;
}

Rgb optimal_vectors(const float* m, const V3f& n) {
  const EvenCoefficients even = even_coefficients(n);
  Rgb sum = dot(n, m);
  for (unsigned i = 0; i < 3; ++i) sum += dot({even.c[i][0], even.c[i][1], even.c[i][2]}, m + 9 * (i + 1));
  const IrradianceBracket bracket = irradiance_bracket(m, n);
  return clamp_to(sum * 0.5F, bracket.lower, bracket.upper);
}

Rgb paper_vectors(const float* m, const V3f& n) {
  Rgb sum(0, 0, 0);
  for (unsigned i = 0; i < 3; ++i) sum += dot_hemisphere(m, i, sgn(n[i]), n) * (n[i] * n[i]);
  return positive(sum);
}

// --- vectors9: the same with D symmetrised, C_ij = int L (sgn w_i w_j + sgn w_j w_i) dw -----------
Rgb optimal_vectors9(const float* m, const V3f& n) {
  const EvenCoefficients even = even_coefficients(n);
  Rgb sum = dot(n, m) + dot({even.c[0][0], even.c[1][1], even.c[2][2]}, m + 9);
  // The least-squares coefficient of a symmetric pair is the mean of the two unsymmetric ones: the pair's block
  // commutes with the swap of its members.
  const V3f pairs(even.c[0][1] + even.c[1][0], even.c[0][2] + even.c[2][0], even.c[1][2] + even.c[2][1]);
  sum += dot(pairs * 0.5F, m + 18);
  const Rgb upper = dot(n, m) + dot({std::abs(n.x), std::abs(n.y), std::abs(n.z)}, m + 9);
  return clamp_to(sum * 0.5F, positive(dot(n, m) * 0.5F), upper * 0.5F);
}

// --- spherical harmonics, Ramamoorthi & Hanrahan 2001 eq. 3 (basis), 9 (A_l) and 10 ---------------
constexpr float y00 = 0.28209479F;  // sqrt(1/(4 pi))
constexpr float y1 = 0.48860251F;   // sqrt(3/(4 pi))
constexpr float y2 = 1.09254843F;   // sqrt(15/(4 pi))
constexpr float y20 = 0.31539157F;  // sqrt(5/(16 pi))
constexpr float y22 = 0.54627422F;  // sqrt(15/(16 pi))
constexpr float a0 = pi;
constexpr float a1 = 2 * pi / 3;
constexpr float a2 = pi / 4;

std::array<float, 9> harmonics(const V3f& w) {
  return {y00,
          y1 * w.y,
          y1 * w.z,
          y1 * w.x,
          y2 * w.x * w.y,
          y2 * w.y * w.z,
          y20 * (3 * w.z * w.z - 1),
          y2 * w.x * w.z,
          y22 * (w.x * w.x - w.y * w.y)};
}

Rgb irradiance_sh(const float* m, const V3f& n, int count) {
  constexpr std::array<float, 9> a{a0, a1, a1, a1, a2, a2, a2, a2, a2};
  const auto y = harmonics(n);
  Rgb sum(0, 0, 0);
  for (std::size_t i = 0; i < std::size_t(count); ++i) sum += load(m + 3 * i) * (a[i] * y[i]);
  return positive(sum);
}

// --- ambient cube (E along the axes, squared-normal weights) --------------------------------------
Rgb irradiance_ambient_cube(const float* m, const V3f& n) {
  Rgb sum(0, 0, 0);
  for (unsigned i = 0; i < 3; ++i) sum += load(m + 3 * (2 * i + (n[i] < 0 ? 1 : 0))) * (n[i] * n[i]);
  return sum;
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
  const auto y = harmonics(w);
  std::copy_n(y.begin(), function_count(basis), out.begin());
  return out;
}

Rgb irradiance(Basis basis, Reconstruction reconstruction, const float* m, const V3f& n) {
  if (reconstruction == Reconstruction::paper) {
    if (!reads(reconstruction, basis)) throw ParameterError("reconstruction", "paper reads the basis vectors only");
    return paper_vectors(m, n);
  }
  switch (basis) {
    case Basis::vectors:
      return optimal_vectors(m, n);
    case Basis::vectors9:
      return optimal_vectors9(m, n);
    case Basis::sh9:
      return irradiance_sh(m, n, 9);
    case Basis::ambient_cube:
      return irradiance_ambient_cube(m, n);
    case Basis::sh4:
      return irradiance_sh(m, n, 4);
  }
  return {0, 0, 0};
}

// Jensen's inequality for the convex max(0, .) over each of the two hemispheres of an axis bounds E from below, for
// every axis; from above, |n.w| <= sum |n_i| |w_i|.
IrradianceBracket irradiance_bracket(const float* m, const V3f& n) {
  IrradianceBracket bracket{Rgb(0, 0, 0), dot(n, m)};
  for (unsigned i = 0; i < 3; ++i) {
    const Rgb lower = positive(dot_hemisphere(m, i, 1, n)) + positive(dot_hemisphere(m, i, -1, n));
    for (unsigned c = 0; c < 3; ++c) bracket.lower[c] = std::max(bracket.lower[c], lower[c]);
    bracket.upper += load(m + 9 * (i + 1) + 3 * i) * std::abs(n[i]);
  }
  bracket.upper *= 0.5F;
  return bracket;
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
