// One way to light a picture, as `ivory render --method NAME` offers it: the options that only it
// reads, what it checks before work starts, and the rendering itself.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "grid/base/metadata.h"
#include "tools/input/scene.h"
#include "tracer/core/film.h"
#include "tracer/render/render.h"

namespace ivory {

struct GridInputOptions;

struct RenderRequest {
  const SceneInput& input;
  const View& view;
  const RenderParams& params;
  const std::vector<bool>& is_object;  // for each of the scene's instances: is it one that --object names?
  bool indirect_only;  // only light with at least one surface between its source and the first surface seen
  const CommonOptions& common;
};

// A picture, and what was found while it was made.
struct Rendered {
  Rendered(Film picture) : film(std::move(picture)) {}  // NOLINT: most methods find nothing besides
  Film film;
  Metadata found;                   // for the picture's attributes and the result
  std::vector<std::string> doubts;  // what looks wrong
};

struct RenderMethod {
  std::string name;
  std::string summary;               // for the help of --method: "reference path tracer"
  std::vector<std::string> options;  // that it reads and not every method does: "--grid"
  bool uses_objects = false;       // does --object change how it renders? Otherwise objects are just part of the scene
  bool needs_environment = false;  // is --env a must?
  bool direct_only = false;        // does it leave out all indirect light?
  std::string noise_note = {};     // what the measured noise is of, where it is not all that is off
  std::function<void()> check;     // throws UsageError for what its options lack; runs before the scene is loaded
  std::function<void(Scene&)> extend;  // adds to the loaded scene before anything is built from it; may be empty
  std::function<std::vector<std::string>()> files;  // that it reads, given by options; may be empty
  std::function<Rendered(const RenderRequest&)> render;
  std::function<void(Metadata&)> describe;  // its parameters, for the picture's attributes
};

// Each adds its options to the command; what the returned functions share lives as long as they do.
RenderMethod make_path_method(Command command);
// --gather, the rays a sample: of the grid's `gather` and of the photon map.
std::shared_ptr<int> add_gather_option(Command command);
std::vector<RenderMethod> make_grid_methods(Command command, const std::shared_ptr<GridInputOptions>& grid,
                                            const std::shared_ptr<int>& gather);  // direct, gather
RenderMethod make_photonmap_method(Command command, const std::shared_ptr<int>& gather);
RenderMethod make_cubemap_method(Command command, const std::shared_ptr<GridInputOptions>& grid);
RenderMethod make_lobes_method(Command command);
RenderMethod make_fiv_method(Command command);

}  // namespace ivory
