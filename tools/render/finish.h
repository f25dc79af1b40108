// What is made of a picture's sums when they are done: the filter, and layers beside the picture.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "grid/base/metadata.h"
#include "tools/cli/options.h"
#include "tracer/image/file.h"
#include "tracer/render/filter/filter.h"
#include "tracer/render/render.h"

namespace ivory {

struct FinishOptions {
  bool filter = false;
  bool layers = false;
};

// --filter, --layers.
void add_finish_options(Command command, FinishOptions& options);
// Throws UsageError where no output keeps layers.
void check(const FinishOptions& options, const std::vector<std::string>& outputs);

// Has what they need kept while the picture is rendered.
void apply(const FinishOptions& options, const LitScene& lit, RenderParams& params);

// Nothing without --filter. Its error takes the place of the noise in the metadata: filter, filter_error, noise (of
// what was filtered).
std::optional<FilteredFilm> filter(const FinishOptions& options, const Film& film, int threads);
void describe(const FilteredFilm& filtered, Metadata& metadata);
std::string filter_text(const FilteredFilm& filtered);  // a whole line
nlohmann::ordered_json filter_json(const FilteredFilm& filtered);

// With --layers, for OpenEXR: albedo.R/G/B, N.X/Y/Z, Z, error.R/G/B, and with --filter noisy.R/G/B.
std::vector<ImageChannel> layers(const FinishOptions& options, const Film& film);

}  // namespace ivory
