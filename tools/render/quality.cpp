#include "tools/render/quality.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/cli/numbers.h"
#include "tools/cli/target_error.h"
#include "tools/cli/usage_error.h"

namespace ivory {

namespace {

// Counts of samples are kept as floats in checkpoints.
constexpr int most_samples = 1 << 24;

bool is_met(const QualityOptions& options, const FilmNoise& noise) { return noise.error.pixel <= *options.target; }

}  // namespace

void add_quality_options(Command command, QualityOptions& options) {
  command.add_count("--samples", options.samples, 1, most_samples, "Samples a pixel");
  add_target_error_option(
      command, options.target,
      "Noise to reach, instead of --samples: the standard error of pixels' luminance, its RMS over the picture\n"
      "÷ the mean luminance, as 2%. Pixels get samples by the noise that is measured around them, 16 at\n"
      "least. What all samples have in common, as the bias of a baked grid, is none of it");
  command.add_count("--max-samples", options.max_samples, least_samples, most_samples,
                    "Samples that a pixel may take with --target-error or --max-time");
  command
      .add_option(
          "--max-time",
          [&options](const std::string& text) {
            const auto seconds = parse_number(text);
            if (!seconds || !(*seconds > 0)) throw UsageError("--max-time: '" + text + "' is not a number above 0");
            options.max_seconds = *seconds;
          },
          "Time that the picture's rays may take; with --target-error until the first of the two is reached.\n"
          "The picture then depends on the machine's speed")
      .type_name("SECONDS");
}

void check(const Command& command, const QualityOptions& options) {
  if (options.is_adaptive() && command.get_option("--samples").given()) {
    throw UsageError(fmt::format("--samples: {} chooses them; --max-samples bounds what a pixel takes",
                                 options.target ? "--target-error" : "--max-time"));
  }
  if (!options.is_adaptive() && command.get_option("--max-samples").given())
    throw UsageError("--max-samples: serves --target-error and --max-time; --samples gives every pixel as many");
}

void apply(const QualityOptions& options, RenderParams& params) {
  params.samples = options.samples;
  if (!options.is_adaptive()) return;
  params.adaptive.emplace();
  params.adaptive->target = options.target.value_or(0);
  params.adaptive->max_samples = options.max_samples;
  if (options.max_seconds) params.adaptive->max_seconds = *options.max_seconds;
}

void describe(const QualityOptions& options, Metadata& metadata) {
  if (!options.is_adaptive()) {
    metadata["samples"] = std::int64_t(options.samples);
    return;
  }
  if (options.target) metadata["target_error"] = *options.target;
  metadata["max_samples"] = std::int64_t(options.max_samples);
  if (options.max_seconds) metadata["max_time_s"] = *options.max_seconds;
}

void describe(const QualityOptions& options, const Film& film, Metadata& metadata) {
  if (!film.noise) return;
  const FilmNoise& noise = *film.noise;
  metadata["noise"] = noise.error.pixel;
  metadata["noise_blocks"] = noise.error.block;
  metadata["noise_standard_error"] = noise.error.pixel_standard_error;
  metadata["samples_least"] = std::int64_t(noise.least_samples);
  metadata["samples_mean"] = noise.mean_samples;
  metadata["samples_most"] = std::int64_t(noise.most_samples);
  if (options.max_seconds) metadata["render_seconds"] = film.render_seconds;
}

std::string noise_text(const QualityOptions& options, const Film& film) {
  if (!film.noise) return {};
  const FilmNoise& noise = *film.noise;
  std::string text = fmt::format("noise {} (+- {}) a pixel, {} by blocks of 8x8", format_share(noise.error.pixel),
                                 format_share(noise.error.pixel_standard_error), format_share(noise.error.block));
  if (options.target) {
    text += fmt::format(", {} {}", is_met(options, noise) ? "within the asked-for" : "MISSES",
                        format_share(*options.target));
  }
  return text + (noise.out_of_time ? "; ended by --max-time\n" : "\n");
}

std::string samples_text(const QualityOptions& options, const Film& film) {
  if (!film.noise || film.noise->least_samples == film.noise->most_samples)
    return fmt::format("{} samples a pixel", film.noise ? film.noise->most_samples : options.samples);
  const FilmNoise& noise = *film.noise;
  return fmt::format("{} to {} samples a pixel, {:.4g} in the mean", noise.least_samples, noise.most_samples,
                     noise.mean_samples);
}

nlohmann::ordered_json noise_json(const QualityOptions& options, const FilmNoise& noise) {
  nlohmann::ordered_json json;
  if (options.target) json["target"] = *options.target;
  json["pixel"] = noise.error.pixel;
  json["block"] = noise.error.block;
  json["pixel_standard_error"] = noise.error.pixel_standard_error;
  if (options.target) json["met"] = is_met(options, noise);
  json["rounds"] = noise.rounds;
  json["out_of_time"] = noise.out_of_time;
  return json;
}

std::vector<std::string> doubts(const QualityOptions& options, const Film& film) {
  if (!options.target || !film.noise || is_met(options, *film.noise)) return {};
  return {fmt::format("the noise of {} misses the asked-for {}, bounded by {}", format_share(film.noise->error.pixel),
                      format_share(*options.target), film.noise->out_of_time ? "--max-time" : "--max-samples")};
}

}  // namespace ivory
