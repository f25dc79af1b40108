// Spherical Gaussians a exp(l (axis.w - 1)), which others light by in cosine lobes' stead: to compare with.
#pragma once

namespace ivory {

// Integral over the sphere of the product of two of sharpness l1, l2 and amplitude 1, their axes alpha apart.
double gaussian_product(double l1, double l2, double alpha);

struct SphericalGaussian {
  double sharpness = 0;
  double amplitude = 0;
};

// Of the solid angle and the mean cosine to its axis that a cap of radiance 1 has. half_angle within (0, pi/2].
SphericalGaussian cap_gaussian(double half_angle);

// E of a Gaussian whose axis is `cosine` from the normal, by two usual ways: the clamped cosine as one Gaussian
// (sharpness 2.133, amplitude 1.17), multiplied exactly; and Hill's fit, both as published with Baking Lab (Pettineo
// and Neubelt 2016). From sharpness 3 on the fit is off by 1.8 % of E at cosine 1 at most; under 1 it is not for use.
double irradiance_by_cosine_gaussian(const SphericalGaussian& light, double cosine);
double irradiance_by_fit(const SphericalGaussian& light, double cosine);

}  // namespace ivory
