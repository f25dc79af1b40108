#include "tracer/bake/fiv/baker.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "tracer/bake/fiv/directions.h"
#include "tracer/bake/fiv/fit.h"
#include "tracer/bake/fiv/gather.h"
#include "tracer/bake/fiv/inside.h"

namespace ivory {

namespace {

// Lights of more than this share of all light cast shadows of their own, which samples alone would alias: what they
// hide is gathered at `oversampling` times the samples along each axis, from finer pictures.
constexpr int bright_parts = 512;
constexpr int oversampling = 2;
constexpr int bright_pixels_factor = 4;

// What the samples of several tables gathered, side by side in one list of positions.
class Joined {
 public:
  void add(const V3i& size, const std::vector<float>& radii) {
    const std::vector<V3f> more = fiv_sample_positions(size, radii);
    begin_.push_back(positions_.size());
    positions_.insert(positions_.end(), more.begin(), more.end());
  }
  const std::vector<V3f>& positions() const { return positions_; }
  std::vector<V3f> positions_of(std::size_t table) const {
    return {positions_.begin() + std::ptrdiff_t(begin(table)), positions_.begin() + std::ptrdiff_t(end(table))};
  }
  // `of_each` numbers a position, those of one table; all of them, which are then gone, where there is no other.
  template <typename T>
  std::vector<T> take(std::vector<T>& all, std::size_t table, std::size_t of_each = 1) const {
    if (begin_.size() == 1) return std::move(all);
    return {all.begin() + std::ptrdiff_t(begin(table) * of_each), all.begin() + std::ptrdiff_t(end(table) * of_each)};
  }

 private:
  std::size_t begin(std::size_t table) const { return begin_[table]; }
  std::size_t end(std::size_t table) const { return table + 1 < begin_.size() ? begin_[table + 1] : positions_.size(); }

  std::vector<V3f> positions_;
  std::vector<std::size_t> begin_;
};

// Tables of those sizes, each with its radii.
std::vector<FivTable> bake(const FivOccluder& occluder, const CubeMap& environment, const FivParams& params,
                           std::span<const V3i> sizes, const std::vector<std::vector<float>>& radii) {
  FivTable shared;
  shared.hemispheres = params.hemispheres;
  shared.center_m = V3f(to_world(occluder.center_m, occluder.anchor_m));
  shared.radius_m = occluder.radius_m;
  shared.shape = occluder.shape;
  const auto numbers = std::size_t(3 * fiv_function_count(params.hemispheres));

  const Intersector object(occluder.scene, params.intersector);
  const FivDirections all = make_fiv_directions(environment, params.environment_size, params.parts);
  shared.total = total_moments(all);
  SplitDirections split{{}, all};
  // Coverage and the inside of the mesh are told by the dim lights: where all are bright, none is.
  if (params.fit) split = split_bright(all, bright_parts);
  if (split.rest.w.empty()) split = {{}, all};
  const auto progress_from = [&](std::size_t before) {
    return [&params, &all, before](std::size_t done) {
      if (params.progress) params.progress(before + done, all.w.size());
    };
  };
  Joined samples;
  Joined refined;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    samples.add(sizes[i], radii[i]);
    refined.add(refined_size(sizes[i], oversampling), refined_radii(radii[i], oversampling));
  }
  FivSums rest = gather_fiv(object, split.rest, samples.positions(), params.hemispheres, params.silhouette_pixels,
                            progress_from(0));
  shared.coverage = float(rest.coverage);
  FivSums bright;
  if (!split.bright.w.empty()) {
    bright = gather_fiv(object, split.bright, refined.positions(), params.hemispheres,
                        params.silhouette_pixels * bright_pixels_factor, progress_from(split.rest.w.size()));
  }

  std::vector<FivTable> tables;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    FivTable table = shared;
    table.size = sizes[i];
    table.radii = radii[i];
    table.values = samples.take(rest.values, i, numbers);
    if (params.fit) table.values = fit_smooth(table.values, table.size, table.radii, numbers);
    if (!split.bright.w.empty()) {
      const std::vector<float> values =
          fit_refined(refined.take(bright.values, i, numbers), table.size, table.radii, oversampling, numbers);
      for (std::size_t k = 0; k < values.size(); ++k) table.values[k] += values[k];
    }
    if (params.fill_inside) {
      std::vector<double> hidden;
      for (const std::uint32_t count : samples.take(rest.hidden, i))
        hidden.push_back(double(count) / double(split.rest.w.size()));
      fill_inside(table, find_inside(object, samples.positions_of(i), hidden));
    }
    tables.push_back(std::move(table));
  }
  return tables;
}

void check_environment_size(const CubeMap& environment, const FivParams& params) {
  if (params.environment_size < 1 || environment.size % params.environment_size != 0) {
    throw ParameterError("environment_size",
                         fmt::format("{} does not divide the {} texels along the environment's faces",
                                     params.environment_size, environment.size));
  }
}

}  // namespace

FivTable bake_fiv(const FivOccluder& occluder, const CubeMap& environment, const FivParams& params) {
  check_environment_size(environment, params);
  const std::array<V3i, 1> sizes{params.samples};
  const std::array<int, 1> counts{int(params.samples.z)};
  const std::vector<std::vector<float>> radii = params.radii.empty() ? fiv_radii(occluder, environment, params, counts)
                                                                     : std::vector<std::vector<float>>{params.radii};
  return bake(occluder, environment, params, sizes, radii).front();
}

std::vector<FivTable> bake_fivs(const FivOccluder& occluder, const CubeMap& environment, const FivParams& params,
                                std::span<const V3i> sizes) {
  check_environment_size(environment, params);
  std::vector<int> counts;
  for (const V3i& size : sizes) counts.push_back(size.z);
  return bake(occluder, environment, params, sizes, fiv_radii(occluder, environment, params, counts));
}

}  // namespace ivory
