// Integral and vector moment of products of cosine lobes, in double and to near full precision: what the tables of
// grid/lobes/table.h are built from and judged by.
#pragma once

#include <vector>

namespace ivory {

// max(a1.w,0)^e1 max(a2.w,0)^e2 over the sphere; exponents from 0, alpha_rad (0 to pi) the angle between the axes.
struct LobeProductMoments {
  double log_integral = 0;    // natural logarithm of the integral; -infinity where the supports do not meet
  double axis_angle_rad = 0;  // of the vector moment, from a1 towards a2
  double exponent = 0;        // of the lobe with the product's mean cosine: 1/(1 - mean cosine) - 2
};
LobeProductMoments lobe_product_moments(double e1, double e2, double alpha_rad);

// A lobe max(cos(theta - angle),0)^exponent whose axis lies in one plane with others.
struct PlanarLobe {
  double exponent = 0;
  double angle_rad = 0;
};

// Logarithm of the integral of the product of any number of lobes with axes in one plane.
double log_planar_product(const std::vector<PlanarLobe>& lobes);

}  // namespace ivory
