// E of many footprints: each one's moments are added up by themselves, with their functions side by side; then E is
// made of those of eight points, with the points side by side.
#include <algorithm>
#include <cassert>

#include "grid/base/error.h"
#include "grid/field/batch/blocks.h"
#include "grid/field/batch/corner_lanes.h"

namespace ivory {

namespace {

using lanes::Vector;

// [moment][point]
template <std::size_t stride>
using EightMoments = std::array<EightFloats, stride>;

// As irradiance_of() adds them up, entry after entry; those without weight add nothing. The last lanes overlap others.
template <std::size_t stride>
void add_up(const IrradianceGrid& grid, const Footprint& footprint, std::size_t point, EightMoments<stride>& out) {
  constexpr std::size_t width = lane_count;
  constexpr std::size_t parts = (stride + width - 1) / width;
  const auto begin = [](std::size_t part) { return std::min(part * width, stride - width); };
  std::array<Lanes, parts> sum;
  sum.fill(Lanes(0.0F));
  for (std::size_t entry = 0; entry < std::size_t(footprint.count); ++entry) {
    if (footprint.weight[entry] == 0) continue;
    const Lanes weight = footprint.weight[entry];
    const float* const vertex = grid.moments.data() + footprint.vertex[entry] * stride;
    for (std::size_t part = 0; part < parts; ++part) sum[part] += weight * to_lanes(vertex + begin(part));
  }
  std::array<float, stride> moments;
  for (std::size_t part = 0; part < parts; ++part)
    sum[part].copy_to(moments.data() + begin(part), stdx::element_aligned);
  for (std::size_t i = 0; i < stride; ++i) out[i][point] = moments[i];
}

// Of each channel by value(its moments).
template <std::size_t stride, typename Value>
std::array<Lanes, 3> of_channels(const EightMoments<stride>& moments, const Value& value) {
  std::array<Lanes, 3> out;
  std::array<Lanes, stride> m;
  for (std::size_t i = 0; i < stride; ++i) m[i] = lanes::load(moments[i]);
  for (std::size_t c = 0; c < 3; ++c) out[c] = value(kernels::Channel<Lanes>{m.data() + c});
  return out;
}

// Each stride has the bases of so many functions.
template <std::size_t stride>
std::array<Lanes, 3> reconstruct([[maybe_unused]] Basis basis, const EightMoments<stride>& moments, const Vector& n) {
  if constexpr (stride == 36) {
    const auto even = kernels::even_coefficients(n);
    return of_channels(moments, [&](const auto& m) { return kernels::optimal_vectors(m, n, even); });
  } else if constexpr (stride == 18) {
    return of_channels(moments, [&](const auto& m) { return kernels::irradiance_ambient_cube(m, n); });
  } else {
    if constexpr (stride == 27) {
      if (basis == Basis::vectors9) {
        const auto even = kernels::even_coefficients(n);
        return of_channels(moments, [&](const auto& m) { return kernels::optimal_vectors9(m, n, even); });
      }
    }
    const auto of_normal = kernels::irradiance_harmonics(n);
    return of_channels(moments, [&](const auto& m) { return kernels::irradiance_sh(m, of_normal, stride / 3); });
  }
}

template <std::size_t stride>
void irradiance_of(const IrradianceGrid& grid, std::span<const Footprint> footprints, std::span<const V3f> n,
                   std::span<Rgb> e) {
  EightMoments<stride> moments{};
  std::array<EightFloats, 3> normals;
  for (std::size_t first = 0; first < footprints.size(); first += points_at_once) {
    const std::size_t count = std::min(points_at_once, footprints.size() - first);
    for (std::size_t i = 0; i < points_at_once; ++i) {
      const std::size_t point = first + std::min(i, count - 1);
      for (unsigned axis = 0; axis < 3; ++axis) normals[axis][i] = n[point][axis];
      if (i < count) add_up(grid, footprints[point], i, moments);
    }
    const Vector local = lanes::direction_to_local(grid.frame, lanes::load(normals));
    const std::array<Lanes, 3> sum = reconstruct(grid.basis, moments, local);
    // Weights of either sign can leave moments that no light has.
    for (unsigned c = 0; c < 3; ++c) {
      const Lanes value = kernels::larger(sum[c], Lanes(0.0F));
      for (std::size_t i = 0; i < count; ++i) e[first + i][c] = value[i];
    }
  }
}

}  // namespace

void irradiance(const IrradianceGrid& grid, std::span<const Footprint> footprints, std::span<const V3f> n,
                Reconstruction reconstruction, std::span<Rgb> e) {
  assert(footprints.size() == n.size() && footprints.size() == e.size());
  if (reconstruction == Reconstruction::paper) {
    for (std::size_t i = 0; i < footprints.size(); ++i) e[i] = irradiance(grid, footprints[i], n[i], reconstruction);
    return;
  }
  switch (function_count(grid.basis)) {
    case 12:
      return irradiance_of<36>(grid, footprints, n, e);
    case 9:
      return irradiance_of<27>(grid, footprints, n, e);
    case 6:
      return irradiance_of<18>(grid, footprints, n, e);
    default:
      return irradiance_of<12>(grid, footprints, n, e);
  }
}

}  // namespace ivory
