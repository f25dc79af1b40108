#include "tracer/bake/fiv/baker.h"

#include <algorithm>

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

}  // namespace

FivTable bake_fiv(const FivOccluder& occluder, const CubeMap& environment, const FivParams& params) {
  if (params.environment_size < 1 || environment.size % params.environment_size != 0)
    throw ParameterError("environment_size",
                         fmt::format("{} does not divide the {} texels along the environment's faces",
                                     params.environment_size, environment.size));
  FivTable table;
  table.size = params.samples;
  table.hemispheres = params.hemispheres;
  table.center_m = V3f(to_world(occluder.center_m, occluder.anchor_m));
  table.radius_m = occluder.radius_m;
  table.shape = occluder.shape;
  table.radii = params.radii.empty() ? fiv_radii(occluder, environment, params) : params.radii;
  const auto numbers = std::size_t(3 * fiv_function_count(table.hemispheres));

  const Intersector object(occluder.scene);
  const FivDirections all = make_fiv_directions(environment, params.environment_size, params.parts);
  table.total = total_moments(all);
  SplitDirections split{{}, all};
  // Coverage and the inside of the mesh are told by the dim lights: where all are bright, none is.
  if (params.fit) split = split_bright(all, bright_parts);
  if (split.rest.w.empty()) split = {{}, all};
  const auto progress_from = [&](std::size_t before) {
    return [&params, &all, before](std::size_t done) {
      if (params.progress) params.progress(before + done, all.w.size());
    };
  };
  const std::vector<V3f> positions = fiv_sample_positions(table.size, table.radii);
  FivSums rest =
      gather_fiv(object, split.rest, positions, table.hemispheres, params.silhouette_pixels, progress_from(0));
  table.coverage = float(rest.coverage);
  table.values = params.fit ? fit_smooth(rest.values, table.size, table.radii, numbers) : std::move(rest.values);
  if (!split.bright.w.empty()) {
    const std::vector<V3f> refined =
        fiv_sample_positions(refined_size(table.size, oversampling), refined_radii(table.radii, oversampling));
    const FivSums bright =
        gather_fiv(object, split.bright, refined, table.hemispheres, params.silhouette_pixels * bright_pixels_factor,
                   progress_from(split.rest.w.size()));
    const std::vector<float> values = fit_refined(bright.values, table.size, table.radii, oversampling, numbers);
    for (std::size_t i = 0; i < values.size(); ++i) table.values[i] += values[i];
  }
  if (params.fill_inside) {
    std::vector<double> hidden;
    for (const std::uint32_t count : rest.hidden) hidden.push_back(double(count) / double(split.rest.w.size()));
    fill_inside(table, find_inside(object, positions, hidden));
  }
  return table;
}

}  // namespace ivory
