// The arithmetic of a look-up for F = float, one point at a time, and for lanes of floats, many (batch/lanes.h): one
// source, so that both give the same numbers to the last bit.
#pragma once

#include <array>
#include <cmath>

#include "grid/base/types.h"

namespace ivory {

inline float select(bool which, float yes, float no) { return which ? yes : no; }

namespace kernels {

template <typename F>
using Triple = std::array<F, 3>;

template <typename F>
F larger(const F& a, const F& b) {
  return select(a < b, b, a);  // as std::max(a, b)
}
template <typename F>
F smaller(const F& a, const F& b) {
  return select(b < a, b, a);
}
template <typename F>
F positive(const F& value) {
  return larger(F(0.0F), value);
}

// Within 2e-8 before rounding (Abramowitz & Stegun, Handbook of Mathematical Functions, 4.4.46), as its twin in
// shaders/field/basis.glsl; the C library's takes a fifth of a look-up. |x| <= 1.
template <typename F>
F arcsine(const F& x) {
  using std::sqrt;
  const F a = select(x < F(0.0F), -x, x);
  F p(-0.0012624911F);
  p = p * a + F(0.0066700901F);
  p = p * a - F(0.0170881256F);
  p = p * a + F(0.0308918810F);
  p = p * a - F(0.0501743046F);
  p = p * a + F(0.0889789874F);
  p = p * a - F(0.2145988016F);
  p = p * a + F(1.5707963050F);
  const F angle = F(0.5F * pi) - sqrt(F(1.0F) - a) * p;
  return select(x < F(0.0F), -angle, angle);
}

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
inline constexpr float gram_p = 4 * pi / 3;
inline constexpr float gram_q = 8.0F / 3;

template <typename F>
struct EvenCoefficients {
  std::array<Triple<F>, 3> c;  // c[i][i] = a_i, c[i][j] = b_ij
};

template <typename F>
EvenCoefficients<F> even_coefficients(const Triple<F>& n) {
  using std::sqrt;
  Triple<F> angle;
  Triple<F> rhs;
  for (unsigned i = 0; i < 3; ++i) {
    const F ni = smaller(larger(n[i], F(-1.0F)), F(1.0F));
    angle[i] = arcsine(ni);
    rhs[i] = F(gram_q) * (sqrt(F(1.0F) - ni * ni) + ni * angle[i]);
  }
  // (p - q) I + q 1 1^T has the inverse (I - q/(p + 2q) 1 1^T) / (p - q); the constraint then replaces the common part
  // by what makes the sum one.
  constexpr float spread = 1 / (gram_p - gram_q);
  const F mean = (rhs[0] + rhs[1] + rhs[2]) * F(1.0F / 3);
  EvenCoefficients<F> out;
  for (unsigned i = 0; i < 3; ++i) out.c[i][i] = (rhs[i] - mean) * F(spread) + F(1.0F / 3);
  constexpr float scale = gram_q / (gram_p * gram_p - gram_q * gram_q);
  for (unsigned i = 0; i < 3; ++i) {
    for (unsigned j = 0; j < 3; ++j) {
      if (i != j) out.c[i][j] = F(scale) * (F(gram_p) * n[j] * angle[i] - F(gram_q) * n[i] * angle[j]);
    }
  }
  return out;
}

// The moments of one colour channel: at(k) is that of function k.
template <typename F>
struct Channel {
  const F* moments;  // [function][rgb], from the channel's first on
  const F& at(unsigned function) const { return moments[std::size_t(3) * function]; }
  // n.v for the vector of three functions.
  F dot(const Triple<F>& n, unsigned function) const {
    return at(function) * n[0] + at(function + 1) * n[1] + at(function + 2) * n[2];
  }
};

// Jensen's inequality for the convex max(0, .) over each of the two hemispheres of an axis bounds E from below, for
// every axis; from above, |n.w| <= sum |n_i| |w_i|.
template <typename F>
struct Bracket {
  F lower;
  F upper;
};
template <typename F>
Bracket<F> bracket(const Channel<F>& m, const Triple<F>& n) {
  const F f = m.dot(n, 0);
  Bracket<F> out{F(0.0F), f};
  for (unsigned i = 0; i < 3; ++i) {
    const F d = m.dot(n, 3 * (i + 1));
    out.lower = larger(out.lower, positive((f + d) * F(0.5F)) + positive((f - d) * F(0.5F)));
    out.upper = out.upper + m.at(3 * (i + 1) + i) * select(n[i] < F(0.0F), -n[i], n[i]);
  }
  out.upper = out.upper * F(0.5F);
  return out;
}

template <typename F>
F clamp_to(const F& value, const F& lower, const F& upper) {
  return smaller(larger(value, lower), larger(lower, upper));
}

template <typename F>
F optimal_vectors(const Channel<F>& m, const Triple<F>& n, const EvenCoefficients<F>& even) {
  F sum = m.dot(n, 0);
  for (unsigned i = 0; i < 3; ++i) sum = sum + m.dot(even.c[i], 3 * (i + 1));
  const Bracket<F> bounds = bracket(m, n);
  return clamp_to(sum * F(0.5F), bounds.lower, bounds.upper);
}

// --- vectors9: the same with D symmetrised, C_ij = int L (sgn w_i w_j + sgn w_j w_i) dw -----------
template <typename F>
F optimal_vectors9(const Channel<F>& m, const Triple<F>& n, const EvenCoefficients<F>& even) {
  const F f = m.dot(n, 0);
  // The least-squares coefficient of a symmetric pair is the mean of the two unsymmetric ones: the pair's block
  // commutes with the swap of its members.
  const F half(0.5F);
  const Triple<F> pairs{(even.c[0][1] + even.c[1][0]) * half, (even.c[0][2] + even.c[2][0]) * half,
                        (even.c[1][2] + even.c[2][1]) * half};
  const F sum = f + m.dot({even.c[0][0], even.c[1][1], even.c[2][2]}, 3) + m.dot(pairs, 6);
  Triple<F> size;
  for (unsigned i = 0; i < 3; ++i) size[i] = select(n[i] < F(0.0F), -n[i], n[i]);
  const F upper = f + m.dot(size, 3);
  return clamp_to(sum * half, positive(f * half), upper * half);
}

// --- spherical harmonics, Ramamoorthi & Hanrahan 2001 eq. 3 (basis), 9 (A_l) and 10 ---------------
inline constexpr float y00 = 0.28209479F;  // sqrt(1/(4 pi))
inline constexpr float y1 = 0.48860251F;   // sqrt(3/(4 pi))
inline constexpr float y2 = 1.09254843F;   // sqrt(15/(4 pi))
inline constexpr float y20 = 0.31539157F;  // sqrt(5/(16 pi))
inline constexpr float y22 = 0.54627422F;  // sqrt(15/(16 pi))

template <typename F>
std::array<F, 9> harmonics(const Triple<F>& w) {
  return {F(y00),
          F(y1) * w[1],
          F(y1) * w[2],
          F(y1) * w[0],
          F(y2) * w[0] * w[1],
          F(y2) * w[1] * w[2],
          F(y20) * (F(3.0F) * w[2] * w[2] - F(1.0F)),
          F(y2) * w[0] * w[2],
          F(y22) * (w[0] * w[0] - w[1] * w[1])};
}

// The harmonics of n times A_l: E is the moments' product with them.
template <typename F>
std::array<F, 9> irradiance_harmonics(const Triple<F>& n) {
  constexpr float a0 = pi;
  constexpr float a1 = 2 * pi / 3;
  constexpr float a2 = pi / 4;
  constexpr std::array<float, 9> a{a0, a1, a1, a1, a2, a2, a2, a2, a2};
  std::array<F, 9> out = harmonics(n);
  for (std::size_t i = 0; i < 9; ++i) out[i] = F(a[i]) * out[i];
  return out;
}

template <typename F>
F irradiance_sh(const Channel<F>& m, const std::array<F, 9>& of_normal, unsigned count) {
  F sum(0.0F);
  for (unsigned i = 0; i < count; ++i) sum = sum + m.at(i) * of_normal[i];
  return positive(sum);
}

// --- ambient cube (E along the axes, squared-normal weights) --------------------------------------
template <typename F>
F irradiance_ambient_cube(const Channel<F>& m, const Triple<F>& n) {
  F sum(0.0F);
  for (unsigned i = 0; i < 3; ++i) sum = sum + select(n[i] < F(0.0F), m.at(2 * i + 1), m.at(2 * i)) * (n[i] * n[i]);
  return sum;
}

// --- guard planes: guard.h says what a word holds ------------------------------------------------
inline constexpr float normal_step = 2.0F / 1023;
inline constexpr float distance_step = 4.0F / 4094;

template <typename F>
struct Plane {
  Triple<F> normal;
  F distance;
  F beyond(const Triple<F>& u) const { return normal[0] * u[0] + normal[1] * u[1] + normal[2] * u[2] - distance; }
};
// From the three numbers of a word. Octahedral mapping after Cigolle et al. (guard.cpp).
template <typename F>
Plane<F> plane_of(const F& octahedral_x, const F& octahedral_y, const F& distance) {
  using std::sqrt;
  const F one(1.0F);
  F x = octahedral_x * F(normal_step) - one;
  F y = octahedral_y * F(normal_step) - one;
  const F z = one - select(x < F(0.0F), -x, x) - select(y < F(0.0F), -y, y);
  // Where z < 0 the octahedron's corner is folded over: x becomes (1 - |y|) sgn x = x + z sgn x, y likewise.
  const F fold = smaller(z, F(0.0F));
  x = x + select(x < F(0.0F), -fold, fold);
  y = y + select(y < F(0.0F), -fold, fold);
  const F scale = one / sqrt(x * x + y * y + z * z);
  return {{x * scale, y * scale, z * scale}, (distance - one) * F(distance_step) - F(2.0F)};
}

}  // namespace kernels
}  // namespace ivory
