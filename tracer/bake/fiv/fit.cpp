#include "tracer/bake/fiv/fit.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

namespace ivory {

namespace {

// Lines of samples along one axis of a block of values, each of `numbers` functions.
struct Lines {
  int axis;
  std::size_t count;   // lines
  std::size_t stride;  // between neighbours on a line, in samples
  std::size_t length;
};

Lines lines_along(const V3i& size, int axis) {
  const std::size_t total = std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z);
  const std::size_t strides[3] = {1, std::size_t(size.x), std::size_t(size.x) * std::size_t(size.y)};
  return {axis, total / std::size_t(size[axis]), strides[axis], std::size_t(size[axis])};
}

std::size_t line_start(const Lines& lines, std::size_t line) {
  return line / lines.stride * lines.stride * lines.length + line % lines.stride;
}

// Interpolation divides by the falloff, so that is what is fitted.
void scale_by_falloff(std::vector<float>& values, const V3i& size, const std::vector<float>& radii, std::size_t numbers,
                      bool divide) {
  const std::size_t shell = std::size_t(size.x) * std::size_t(size.y) * numbers;
  for (std::size_t k = 0; k < radii.size(); ++k) {
    const float factor = divide ? 1 / fiv_falloff(radii[k]) : fiv_falloff(radii[k]);
    for (std::size_t i = 0; i < shell; ++i) values[k * shell + i] *= factor;
  }
}

// Least squares of hat functions along one line. With refined samples at fractions t = j / m of the intervals the
// normal matrix has sum t^2-like entries on the diagonal and sum t (1 - t) beside it; it is strictly dominated by its
// diagonal (at worst 3 to 1), so that Gauss and Seidel's sweeps converge by a factor of four each.
void fit_line(const float* in, std::size_t in_stride, float* out, std::size_t out_stride, std::size_t count, int m,
              bool periodic) {
  constexpr int sweeps = 14;  // 4^-14 is below a float's rounding
  double both = 0;            // of one interval: t (1 - t)
  double own = 0;             // and (1 - t)^2
  for (int j = 0; j < m; ++j) {
    const double t = double(j) / m;
    both += t * (1 - t);
    own += (1 - t) * (1 - t);
  }
  const double other = own - 1;  // t^2: the same without j = 0
  std::vector<double> right(count);
  std::vector<double> diagonal(count);
  const std::size_t refined = count * std::size_t(m);
  for (std::size_t i = 0; i < count; ++i) {
    const bool has_next = periodic || i + 1 < count;
    const bool has_previous = periodic || i > 0;
    // Samples at the ends of a line that does not close stand for half an interval.
    const double node = has_next && has_previous ? 1 : 0.5;
    diagonal[i] = node + (has_next ? own - 1 : 0) + (has_previous ? other : 0);
    double sum = node * double(in[i * std::size_t(m) * in_stride]);
    for (int j = 1; j < m; ++j) {
      const double weight = 1 - double(j) / m;
      const std::size_t at = i * std::size_t(m);
      if (has_next) sum += weight * double(in[(at + std::size_t(j)) * in_stride]);
      if (has_previous) sum += weight * double(in[(at + refined - std::size_t(j)) % refined * in_stride]);
    }
    right[i] = sum;
  }
  std::vector<double> x(count);
  for (std::size_t i = 0; i < count; ++i) x[i] = double(in[i * std::size_t(m) * in_stride]);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (std::size_t i = 0; i < count; ++i) {
      double sum = right[i];
      if (periodic || i + 1 < count) sum -= both * x[(i + 1) % count];
      if (periodic || i > 0) sum -= both * x[(i + count - 1) % count];
      x[i] = sum / diagonal[i];
    }
  }
  for (std::size_t i = 0; i < count; ++i) out[i * out_stride] = float(x[i]);
}

}  // namespace

V3i refined_size(const V3i& size, int oversampling) {
  return {size.x * oversampling, (size.y - 1) * oversampling + 1, (size.z - 1) * oversampling + 1};
}

std::vector<float> refined_radii(const std::vector<float>& radii, int oversampling) {
  std::vector<float> out;
  for (std::size_t k = 0; k + 1 < radii.size(); ++k) {
    for (int j = 0; j < oversampling; ++j)
      out.push_back(radii[k] * std::pow(radii[k + 1] / radii[k], float(j) / float(oversampling)));
  }
  out.push_back(radii.back());
  return out;
}

std::vector<float> fit_refined(const std::vector<float>& values, const V3i& size, const std::vector<float>& radii,
                               int oversampling, std::size_t numbers) {
  std::vector<float> from = values;
  V3i from_size = refined_size(size, oversampling);
  scale_by_falloff(from, from_size, refined_radii(radii, oversampling), numbers, true);
  // Hats of three variables are products, and the refined samples stand on a grid: the fit separates into its axes.
  for (const int axis : {2, 1, 0}) {
    V3i to_size = from_size;
    to_size[axis] = size[axis];
    const Lines in = lines_along(from_size, axis);
    const Lines out = lines_along(to_size, axis);
    std::vector<float> to(std::size_t(to_size.x) * std::size_t(to_size.y) * std::size_t(to_size.z) * numbers);
    tbb::parallel_for(std::size_t(0), in.count, [&](std::size_t line) {
      for (std::size_t i = 0; i < numbers; ++i) {
        fit_line(from.data() + line_start(in, line) * numbers + i, in.stride * numbers,
                 to.data() + line_start(out, line) * numbers + i, out.stride * numbers, out.length, oversampling,
                 axis == 0);
      }
    });
    from = std::move(to);
    from_size = to_size;
  }
  scale_by_falloff(from, size, radii, numbers, false);
  return from;
}

std::vector<float> fit_smooth(const std::vector<float>& values, const V3i& size, const std::vector<float>& radii,
                              std::size_t numbers) {
  std::vector<float> from = values;
  scale_by_falloff(from, size, radii, numbers, true);
  for (const int axis : {2, 1, 0}) {
    const Lines lines = lines_along(size, axis);
    std::vector<float> to = from;
    tbb::parallel_for(std::size_t(0), lines.count, [&](std::size_t line) {
      const std::size_t start = line_start(lines, line);
      for (std::size_t k = 0; k < lines.length; ++k) {
        if (axis != 0 && (k == 0 || k + 1 == lines.length)) continue;
        const std::size_t here = (start + k * lines.stride) * numbers;
        const std::size_t before = (start + (k + lines.length - 1) % lines.length * lines.stride) * numbers;
        const std::size_t after = (start + (k + 1) % lines.length * lines.stride) * numbers;
        for (std::size_t i = 0; i < numbers; ++i)
          to[here + i] -= (from[before + i] - 2 * from[here + i] + from[after + i]) / 12;
      }
    });
    from = std::move(to);
  }
  scale_by_falloff(from, size, radii, numbers, false);
  return from;
}

}  // namespace ivory
