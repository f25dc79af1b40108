#include "grid/field/resolve.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <tbb/parallel_for.h>

namespace ivory {
namespace {

// Moments of one vertex while they are folded: [function][rgb], double as the sums are wide.
using Moments = std::array<double, std::size_t(max_functions) * 3>;

// F = sum of octant vectors, D_i = the same with the sign of w_i (basis.h's order for `vectors`).
Moments fold_octants(const std::int64_t* sums, const SumLayout& layout) {
  Moments out{};
  for (std::size_t octant = 0; octant < 8; ++octant) {
    const std::int64_t* slot = sums + octant * std::size_t(layout.lanes());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double sign = ((octant >> axis) & 1U) != 0 ? -1 : 1;
      for (std::size_t c = 0; c < 3; ++c) {
        const double component = sign * static_cast<double>(slot[3 * axis + c]);
        out[3 * axis + c] += component;
        for (std::size_t i = 0; i < 3; ++i) {
          out[9 * (i + 1) + 3 * axis + c] += ((octant >> i) & 1U) != 0 ? -component : component;
        }
      }
    }
  }
  return out;
}

Moments fold_hemispheres(const std::int64_t* sums, const SumLayout& layout, const V3f& area) {
  std::array<double, 54> hemispheres{};
  for (std::size_t delta = 0; delta < 6; ++delta) {
    for (std::size_t i = 0; i < 9; ++i) {
      hemispheres[9 * delta + i] =
          static_cast<double>(sums[delta * std::size_t(layout.lanes()) + i]) / area[static_cast<unsigned>(delta / 2)];
    }
  }
  Moments out{};
  for (std::size_t i = 0; i < 9; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double plus = hemispheres[18 * axis + i];
      const double minus = hemispheres[18 * axis + 9 + i];
      out[i] += (plus + minus) / 3;  // the three axes measure the same F independently
      out[9 * (axis + 1) + i] = plus - minus;
    }
  }
  return out;
}

// vectors9 and ambient_cube are linear in F and D.
Moments convert_from_vectors(Basis basis, const Moments& v) {
  if (basis == Basis::vectors) return v;
  const auto d = [&](std::size_t i, std::size_t j, std::size_t c) { return v[9 * (i + 1) + 3 * j + c]; };
  Moments out{};
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double f = v[3 * i + c];
      if (basis == Basis::ambient_cube) {
        out[6 * i + c] = (d(i, i, c) + f) / 2;
        out[6 * i + 3 + c] = (d(i, i, c) - f) / 2;
      } else {
        out[3 * i + c] = f;
        out[9 + 3 * i + c] = d(i, i, c);
      }
    }
    if (basis == Basis::vectors9) {
      out[18 + c] = d(0, 1, c) + d(1, 0, c);
      out[21 + c] = d(0, 2, c) + d(2, 0, c);
      out[24 + c] = d(1, 2, c) + d(2, 1, c);
    }
  }
  return out;
}

// Of those sums, which are the accumulator's own or a group's.
StoredMoments resolve(const GridAccumulator& accumulator, const std::vector<std::int64_t>& sums) {
  const SumLayout layout = sum_layout(accumulator.basis, accumulator.estimator);
  const std::size_t vertices = accumulator.vertex_count();
  const auto stride = std::size_t(function_count(accumulator.basis)) * 3;
  assert(sums.size() == vertices * std::size_t(layout.stride()));
  const auto photons = static_cast<double>(accumulator.photon_end - accumulator.photon_begin);

  StoredMoments out{std::vector<float>(vertices * stride, 0.0F), std::vector<Rgb>(vertices, Rgb(0, 0, 0))};
  if (photons == 0) return out;

  tbb::parallel_for(std::size_t(0), vertices, [&](std::size_t vertex) {
    const int level = accumulator.level_of(std::uint32_t(vertex));
    const V3f h = accumulator.frame_of(level).spacing_m;
    const double quantum = std::ldexp(accumulator.quantum, -level);
    const double quantum_squared = std::ldexp(accumulator.quantum_squared, -2 * level);
    const float fraction = accumulator.visible_fraction[vertex];
    if (fraction <= 0) return;
    const std::int64_t* source = sums.data() + vertex * std::size_t(layout.stride());

    double measure = 0;  // m^3 or m^2, times photons
    Moments moments{};
    if (accumulator.estimator == Estimator::track) {
      measure = photons * double(h.x) * h.y * h.z * fraction;
      if (layout.slots == 8) {
        moments = convert_from_vectors(accumulator.basis, fold_octants(source, layout));
      } else {
        for (std::size_t f = 0; f < std::size_t(layout.functions) * 3; ++f) moments[f] = static_cast<double>(source[f]);
      }
    } else {
      measure = photons;
      moments = fold_hemispheres(source, layout, V3f(h.y * h.z, h.x * h.z, h.x * h.y));
    }

    float* target = out.moments.data() + vertex * stride;
    for (std::size_t f = 0; f < stride; ++f) target[f] = static_cast<float>(moments[f] * quantum / measure);

    // Photons arrive independently, so the variance of a sum is the sum of squares. A receiver weighs each with max(0,
    // n.w), whose square averages 1/3 over its hemisphere.
    const double area =
        accumulator.estimator == Estimator::track ? 1.0 : std::cbrt(double(h.x) * h.y * h.z * h.x * h.y * h.z);
    for (unsigned c = 0; c < 3; ++c) {
      double squares = 0;
      for (int slot = 0; slot < layout.slots; ++slot)
        squares += static_cast<double>(source[slot * layout.lanes() + 3 * layout.functions + int(c)]);
      out.variance[vertex][c] = static_cast<float>(squares * quantum_squared / (3 * measure * measure * area * area));
    }
  });
  return out;
}

}  // namespace

IrradianceGrid resolve(const GridAccumulator& accumulator) {
  return {accumulator, resolve(accumulator, accumulator.sums), {}};
}

IrradianceGrid resolve_groups(const GridAccumulator& accumulator) {
  IrradianceGrid grid = resolve(accumulator);
  for (const SumGroup& group : accumulator.groups)
    grid.groups.push_back({resolve(accumulator, group.sums), group.name});
  return grid;
}

}  // namespace ivory
