// How good a picture is to be: options of samples, error and time, and what is said of the noise that was reached.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "grid/base/metadata.h"
#include "tools/cli/options.h"
#include "tracer/render/render.h"

namespace ivory {

struct QualityOptions {
  int samples = RenderParams{}.samples;
  std::optional<double> target;  // share
  int max_samples = AdaptiveParams{}.max_samples;
  std::optional<double> max_seconds;

  bool is_adaptive() const { return target.has_value() || max_seconds.has_value(); }
};

// --samples, --target-error, --max-samples, --max-time.
void add_quality_options(Command command, QualityOptions& options);
// Throws UsageError for what does not go together.
void check(const Command& command, const QualityOptions& options);

void apply(const QualityOptions& options, RenderParams& params);

// What was asked for: part of what a checkpoint has to agree with.
void describe(const QualityOptions& options, Metadata& metadata);
// What came of it, where noise was measured: noise, noise_blocks, samples_least, samples_mean, samples_most; and
// render_seconds where the clock had a say, which no file keeps else.
void describe(const QualityOptions& options, const Film& film, Metadata& metadata);
// "noise 1.9 % a pixel, 0.24 % by blocks of 8x8, within the asked-for 2 %: ...", a whole line; empty where there is no
// noise to be told.
std::string noise_text(const QualityOptions& options, const Film& film);
// "64 samples a pixel", "16 to 412 samples a pixel, 63.2 in the mean".
std::string samples_text(const QualityOptions& options, const Film& film);
// For the result: target, met, pixel, block, rounds.
nlohmann::ordered_json noise_json(const QualityOptions& options, const FilmNoise& noise);
// A line for a warning each: a target that was missed.
std::vector<std::string> doubts(const QualityOptions& options, const Film& film);

}  // namespace ivory
