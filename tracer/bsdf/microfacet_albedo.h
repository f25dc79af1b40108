// How much of the light that comes to a GGX surface its microfacet lobe reflects.
#pragma once

#include <array>

namespace ivory {

// A bound from above of the directional albedo of the lobe F D V (bsdf.cpp) as a polynomial in 1 - mu, mu the cosine of
// the direction:
//
//   E(mu) <= sum_k e_k (1 - mu)^k <= 1,   E(mu) = integral of F D V |ns.wi| dwi.
//
// Close: for f0 = 0.04, f90 = 1 it lies 0.2 % of the light above E on average over diffuse light, 3.6 % at most for mu
// above 0.2 and 10 % at grazing angles, where Smith's masking takes what no polynomial follows.
using AlbedoPolynomial = std::array<float, 6>;

// f0 and f90 in [0, 1], the largest of the channels; alpha in [1e-3, 1].
AlbedoPolynomial make_albedo_polynomial(float f0, float f90, float alpha);

// 1 - the polynomial at mu in [0, 1], at least 0: what the microfacet lobe leaves to what lies below it.
inline float left_below(const AlbedoPolynomial& e, float mu) {
  const float x = 1.0F - mu;
  const float sum = e[0] + x * (e[1] + x * (e[2] + x * (e[3] + x * (e[4] + x * e[5]))));
  return sum < 1.0F ? 1.0F - sum : 0.0F;
}

// The mean of 1 - the polynomial over diffuse light, 2 integral of (1 - E) mu dmu.
float mean_left_below(const AlbedoPolynomial& e);

}  // namespace ivory
