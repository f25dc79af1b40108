// Which values at a table's samples make trilinear interpolation between them come closest to the light itself.
//
// Values of the function at the samples are not best: between two samples an interpolant stays on one side of a
// curve. The best in the sense of least squares lies 2.4 times closer for smooth functions (root of the mean square:
// sqrt(1/180) against sqrt(1/30) of h^2 f''/2) at the same cost of reading.
#pragma once

#include <vector>

#include "grid/fiv/table.h"

namespace ivory {

// Samples of a table refined `oversampling` times along each axis: every sample sphere and direction of the table is
// kept, with oversampling - 1 more between neighbours.
V3i refined_size(const V3i& size, int oversampling);
std::vector<float> refined_radii(const std::vector<float>& radii, int oversampling);  // even in the logarithm

// Least squares over refined samples: `values` (refined distance x polar x azimuth x numbers) to the table's samples.
// For sharp shadows, which values at samples alone would alias.
std::vector<float> fit_refined(const std::vector<float>& values, const V3i& size, const std::vector<float>& radii,
                               int oversampling, std::size_t numbers);

// The same from the values at the samples themselves, for functions that are smooth between them: along every axis
// the second difference over twelve is taken off, which is the least-squares fit of a parabola.
std::vector<float> fit_smooth(const std::vector<float>& values, const V3i& size, const std::vector<float>& radii,
                              std::size_t numbers);

}  // namespace ivory
