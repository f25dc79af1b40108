#include "tools/render/finish.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/io/file.h"
#include "tools/cli/target_error.h"
#include "tools/cli/usage_error.h"
#include "tracer/core/film_sums.h"

namespace ivory {

namespace {

// What Blender writes where nothing is hit.
constexpr float nothing_m = 1e10F;

}  // namespace

void add_finish_options(Command command, FinishOptions& options) {
  command.add_flag("--filter", options.filter,
                   "Filters the noise that is left, guided by albedo, normal and depth of what is first seen. It is\n"
                   "biased; by how much is estimated and stated, and where that is more than the noise it is not used");
  command.add_flag("--layers", options.layers,
                   "Adds to .exr what denoisers ask for: albedo.R/G/B, N.X/Y/Z (world), Z (metres along the camera's\n"
                   "axis, 1e10 where nothing is), error.R/G/B (a pixel's standard error, from two halves: one number\n"
                   "of chance each) and, with --filter, noisy.R/G/B");
}

void check(const FinishOptions& options, const std::vector<std::string>& outputs) {
  const auto is_exr = [](const std::string& output) { return lower_extension(output) == ".exr"; };
  if (options.layers && std::none_of(outputs.begin(), outputs.end(), is_exr))
    throw UsageError("--layers: only .exr keeps layers; add -o NAME.exr");
}

void apply(const FinishOptions& options, const LitScene& lit, RenderParams& params) {
  if (!options.filter && !options.layers) return;
  params.halves = true;
  params.first_hits_of = &lit;
}

std::optional<FilteredFilm> filter(const FinishOptions& options, const Film& film, int threads) {
  if (!options.filter) return std::nullopt;
  FilterParams params;
  params.threads = threads;
  return filter_film(*film.sums, params);
}

void describe(const FilteredFilm& filtered, Metadata& metadata) {
  metadata["filter"] = std::string(filtered.filtered_share > 0 ? "non-local means with features" : "none helped");
  metadata["filter_error"] = filtered.error;
  metadata["filter_error_high"] = filtered.high;
  metadata["filter_share"] = filtered.filtered_share;
}

std::string filter_text(const FilteredFilm& filtered) {
  if (!(filtered.filtered_share > 0)) return "filter: none helped by the halves' estimate; the picture is unfiltered\n";
  return fmt::format(
      "filter: error {} a pixel (at most {}), noise and bias, by the halves' estimate; {:.0f} % of it filtered\n",
      format_share(filtered.error), format_share(filtered.high), 100 * filtered.filtered_share);
}

nlohmann::ordered_json filter_json(const FilteredFilm& filtered) {
  return {{"error", filtered.error},
          {"high", filtered.high},
          {"unfiltered_error", filtered.unfiltered_error},
          {"filtered_share", filtered.filtered_share}};
}

std::vector<ImageChannel> layers(const FinishOptions& options, const Film& film) {
  std::vector<ImageChannel> channels;
  if (!options.layers) return channels;
  const FilmSums& sums = *film.sums;
  const auto add = [&](const std::string& name, const std::function<float(std::size_t)>& value) {
    ImageChannel channel{name, {}};
    channel.values.reserve(sums.pixel_count());
    for (std::size_t i = 0; i < sums.pixel_count(); ++i) channel.values.push_back(value(i));
    channels.push_back(std::move(channel));
  };
  const char* const rgb[3] = {"R", "G", "B"};
  const char* const xyz[3] = {"X", "Y", "Z"};
  for (int c = 0; c < 3; ++c)
    add(fmt::format("albedo.{}", rgb[c]), [&](std::size_t i) { return sums.first_hit(i).albedo[c]; });
  for (int c = 0; c < 3; ++c)
    add(fmt::format("N.{}", xyz[c]), [&](std::size_t i) { return sums.first_hit(i).normal[unsigned(c)]; });
  add("Z", [&](std::size_t i) {
    const FirstHit first = sums.first_hit(i);
    return first.hit > 0 ? first.depth_m : nothing_m;
  });
  for (int c = 0; c < 3; ++c) {
    add(fmt::format("error.{}", rgb[c]),
        [&](std::size_t i) { return 0.5F * std::abs(sums.radiance(0, i)[c] - sums.radiance(1, i)[c]); });
  }
  if (options.filter) {
    for (int c = 0; c < 3; ++c)
      add(fmt::format("noisy.{}", rgb[c]), [&](std::size_t i) { return sums.radiance(i)[c]; });
  }
  return channels;
}

}  // namespace ivory
