// A baked grid as a source of indirect light: the options that say how it is read, and the checks.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/cli/common.h"
#include "tools/input/scene.h"
#include "tracer/render/final_gather.h"

namespace ivory {

// --guard, --interpolation and --reconstruction, in the help page's group `group` where that is not empty; `guards` is
// what the help says of --guard. Answers --guard.
Option add_lookup_options(Command command, LookupParams& params, const std::string& guards,
                          const std::string& group = {});
// Throws UsageError where `path`, a grid of that basis, cannot be read with the parameters' reconstruction, and Error
// where they ask for guard planes and it has none.
void check_lookup(const std::string& path, Basis basis, bool has_guard, const LookupParams& params);

struct GridInputOptions {
  std::string grid;
  LookupParams lookup{.guard = Guard::rays};
};

// --grid and how it is read; `purpose` is what --grid is for.
std::shared_ptr<GridInputOptions> add_grid_options(Command command, const std::string& purpose);
// Their names.
const std::vector<std::string>& grid_option_names();

// A grid of indirect light that has what the guard needs and was baked under the input's environment. Throws Error and
// UsageError for another; notes where it was baked from another scene.
IrradianceGrid load_grid(const GridInputOptions& options, const SceneInput& input, const CommonOptions& common);

void describe(const GridInputOptions& options, Metadata& metadata);

// What is to be said of a grid's look-ups. In the metadata, where there are such: grid_unseen_share, of those that no
// vertex sees and that read 0, and grid_outside_share, of those outside the grid, which its nearest vertices answer. A
// line each where it is more than a thousandth.
void describe(const LookupTally& tally, Metadata& metadata);
std::vector<std::string> doubts_about(const LookupTally& tally, const GridInputOptions& options);

}  // namespace ivory
