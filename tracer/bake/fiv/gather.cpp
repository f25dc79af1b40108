#include "tracer/bake/fiv/gather.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "tracer/bake/fiv/shadow_cylinders.h"

namespace ivory {

namespace {

// Positions are taken by groups of this many, side by side in azimuth, through the vector units.
constexpr std::size_t lanes = 8;
// Pictures in memory at a time: 64 of 128 x 128 are 4 MiB.
constexpr std::size_t batch = 64;

struct Columns {
  std::vector<float> x, y, z;  // padded to whole groups of lanes
};

Columns to_columns(const std::vector<V3f>& positions) {
  Columns out;
  const std::size_t padded = (positions.size() + lanes - 1) / lanes * lanes;
  for (auto* column : {&out.x, &out.y, &out.z}) column->resize(padded, 0);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    out.x[i] = positions[i].x;
    out.y[i] = positions[i].y;
    out.z[i] = positions[i].z;
  }
  return out;
}

// Errors at silhouettes are in proportion to a light's power and to the width of a pixel, and a picture costs the
// square of its resolution: the least error for the time has lights of a quarter of the power on half the pixels, as
// far down as a mesh's parts are still to be seen.
int pixels_for(float power, double mean_power, int silhouette_pixels) {
  const double share = mean_power > 0 ? std::sqrt(double(power) / mean_power) : 1;
  const int pixels = int(std::ceil(silhouette_pixels * std::clamp(share, 0.5, 1.0) / 8)) * 8;
  return std::min(pixels, silhouette_pixels);
}

double mean_power(const FivDirections& directions) {
  double sum = 0;
  for (const Rgb& power : directions.power) sum += double(max_component(power));
  return directions.power.empty() ? 0 : sum / double(directions.power.size());
}

// What `lanes` positions have gathered of one octant.
struct Gathered {
  std::array<std::array<float, lanes>, 9> sums{};  // [xyz][rgb][lane]
  std::array<std::uint32_t, lanes> hidden{};       // directions
};

// Adds the light of directions [begin, end) of `cylinders` that is hidden from the positions at x, y, z.
void gather_batch(const ShadowCylinders& cylinders, const std::vector<V3f>& w, const std::vector<Rgb>& power,
                  std::size_t offset, const float* x, const float* y, const float* z, Gathered& out) {
  const int resolution = cylinders.resolution;
  const float scale = 0.5F * float(resolution);
  const std::size_t pixels = std::size_t(resolution) * std::size_t(resolution);
  for (std::size_t k = 0; k < cylinders.frames.size(); ++k) {
    const V3f& direction = cylinders.frames[k].z;
    const V3f& right = cylinders.frames[k].x;
    const V3f& up = cylinders.frames[k].y;
    alignas(32) std::array<float, lanes> column;
    alignas(32) std::array<float, lanes> row;
    alignas(32) std::array<float, lanes> height;
    alignas(32) std::array<std::int32_t, lanes> within;
    std::int32_t any = 0;
    for (std::size_t i = 0; i < lanes; ++i) {
      const float u = x[i] * right.x + y[i] * right.y + z[i] * right.z;
      const float v = x[i] * up.x + y[i] * up.y + z[i] * up.z;
      height[i] = x[i] * direction.x + y[i] * direction.y + z[i] * direction.z;
      column[i] = (u + 1) * scale;
      row[i] = (v + 1) * scale;
      within[i] = (u * u + v * v < 1 ? -1 : 0) & (height[i] < 1 ? -1 : 0);
      any |= within[i];
    }
    if (any == 0) continue;
    const float* depth = cylinders.depth.data() + k * pixels;
    alignas(32) std::array<float, lanes> dark;
    any = 0;
    for (std::size_t i = 0; i < lanes; ++i) {
      const std::int32_t pixel = (std::int32_t(row[i]) * resolution + std::int32_t(column[i])) & within[i];
      const std::int32_t is_dark = (height[i] < depth[pixel] ? -1 : 0) & within[i];
      dark[i] = is_dark != 0 ? 1.0F : 0.0F;
      out.hidden[i] -= std::uint32_t(is_dark);
      any |= is_dark;
    }
    if (any == 0) continue;
    const V3f& towards = w[offset + k];
    const Rgb& light = power[offset + k];
    for (unsigned axis = 0; axis < 3; ++axis) {
      for (unsigned c = 0; c < 3; ++c) {
        const float value = towards[axis] * light[c];
        auto& sums = out.sums[3 * axis + c];
        for (std::size_t i = 0; i < lanes; ++i) sums[i] += value * dark[i];
      }
    }
  }
}

}  // namespace

std::vector<V3f> fiv_sample_positions(const V3i& size, const std::vector<float>& radii) {
  std::vector<V3f> positions;
  positions.reserve(radii.size() * std::size_t(size.y) * std::size_t(size.x));
  for (const float r : radii) {
    for (int polar = 0; polar < size.y; ++polar) {
      for (int azimuth = 0; azimuth < size.x; ++azimuth)
        positions.emplace_back(fiv_sample_direction(size, azimuth, polar) * double(r));
    }
  }
  return positions;
}

FivSums gather_fiv(const Intersector& object, const FivDirections& directions, const std::vector<V3f>& positions,
                   int hemispheres, int silhouette_pixels, const std::function<void(std::size_t)>& progress) {
  const Columns columns = to_columns(positions);
  const std::size_t groups = columns.x.size() / lanes;
  const auto numbers = std::size_t(3 * fiv_function_count(hemispheres));
  FivSums out;
  out.values.assign(positions.size() * numbers, 0.0F);
  out.hidden.assign(positions.size(), 0);
  std::vector<Gathered> octant_sums(groups);
  double covered = 0;
  const double mean = mean_power(directions);
  for (std::size_t octant = 0; octant < 8; ++octant) {
    const std::size_t octant_end = directions.octant_begin[octant + 1];
    if (directions.octant_begin[octant] == octant_end) continue;
    std::fill(octant_sums.begin(), octant_sums.end(), Gathered{});
    for (std::size_t begin = directions.octant_begin[octant]; begin < octant_end; begin += batch) {
      const std::size_t end = std::min(begin + batch, octant_end);
      const ShadowCylinders cylinders =
          trace_shadow_cylinders(object, std::span(directions.w).subspan(begin, end - begin),
                                 pixels_for(max_component(directions.power[begin]), mean, silhouette_pixels));
      covered += covered_share(cylinders) * double(end - begin);
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, groups, 64), [&](const auto& range) {
        for (std::size_t group = range.begin(); group < range.end(); ++group) {
          const std::size_t i = group * lanes;
          gather_batch(cylinders, directions.w, directions.power, begin, &columns.x[i], &columns.y[i], &columns.z[i],
                       octant_sums[group]);
        }
      });
      if (progress) progress(end);
    }
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, positions.size(), 512), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const Gathered& sums = octant_sums[i / lanes];
        std::array<float, 72> octants{};
        for (std::size_t j = 0; j < 9; ++j) octants[9 * octant + j] = sums.sums[j][i % lanes];
        const FivMoments moments = fold_octants(octants, hemispheres);
        for (std::size_t j = 0; j < numbers; ++j) out.values[i * numbers + j] += moments[j];
        out.hidden[i] += sums.hidden[i % lanes];
      }
    });
  }
  if (!directions.w.empty()) out.coverage = covered / double(directions.w.size());
  return out;
}

FivSums gather_fiv_by_rays(const Intersector& object, const FivDirections& directions,
                           const std::vector<V3f>& positions, int hemispheres) {
  const auto numbers = std::size_t(3 * fiv_function_count(hemispheres));
  FivSums out;
  out.values.assign(positions.size() * numbers, 0.0F);
  out.hidden.assign(positions.size(), 0);
  tbb::parallel_for(std::size_t(0), positions.size(), [&](std::size_t i) {
    std::array<float, 72> octants{};
    for (std::size_t octant = 0; octant < 8; ++octant) {
      for (std::size_t k = directions.octant_begin[octant]; k < directions.octant_begin[octant + 1]; ++k) {
        Ray ray;
        ray.origin = positions[i];
        ray.direction = directions.w[k];
        if (object.transmittance(ray) > 0.5F) continue;
        ++out.hidden[i];
        for (unsigned j = 0; j < 9; ++j) octants[9 * octant + j] += directions.w[k][j / 3] * directions.power[k][j % 3];
      }
    }
    const FivMoments moments = fold_octants(octants, hemispheres);
    std::copy_n(moments.begin(), numbers, out.values.begin() + std::ptrdiff_t(i * numbers));
  });
  return out;
}

}  // namespace ivory
