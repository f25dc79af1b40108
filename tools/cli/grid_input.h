// A baked grid as a source of indirect light: the options that say how it is read, and the checks.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/cli/common.h"
#include "tools/cli/scene_input.h"
#include "tracer/render/final_gather.h"

namespace ivory {

struct GridInputOptions {
  std::string grid;
  std::string guard = "rays";
  std::string interpolation = "trilinear";
  std::string reconstruction = "optimal";
};

// --grid and how it is read; `purpose` is what --grid is for.
std::shared_ptr<GridInputOptions> add_grid_options(Command command, const std::string& purpose);
// Their names.
const std::vector<std::string>& grid_option_names();

// A grid of indirect light that has what the guard needs and was baked under the input's environment. Throws Error and
// UsageError for another; notes where it was baked from another scene.
IrradianceGrid load_grid(const GridInputOptions& options, const SceneInput& input, const CommonOptions& common);
// How the options read it; `grid` must outlive the answer.
GridLight grid_light(const GridInputOptions& options, const IrradianceGrid& grid);

void describe(const GridInputOptions& options, Metadata& metadata);

}  // namespace ivory
