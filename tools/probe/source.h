// One kind of file that `ivory probe` reads irradiance from: how it is told from the others, the
// options that only it reads, and the reading itself.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "tools/cli/common.h"
#include "tools/input/points.h"
#include "tools/input/scene.h"

namespace ivory {

struct ProbeEstimates {
  std::vector<Rgb> e;                 // lux, one a point
  std::vector<Rgb> standard_error;    // of e; not a number where nothing is known of it
  Metadata facts;                     // for the result: what was read and how
  std::vector<std::string> warnings;  // of all that was read, printed already
  std::vector<std::string> doubts;    // about the estimates, to be printed
};

struct ProbeRequest {
  std::string source;
  const PointsTable& table;
  bool indirect_only;  // leave out light straight from its sources
  const SceneOptions& load;
  const CommonOptions& common;
};

struct ProbeSource {
  std::string name;                                      // plural, for messages: "grids"
  std::vector<std::string> options;                      // that it reads: "--guard"
  bool reads_scenes = false;                             // does it read those of add_scene_options() too?
  std::function<bool(const std::string& path)> matches;  // by name and, for EXR files, header
  std::function<ProbeEstimates(const ProbeRequest&)> probe;
};

// Each adds its options to the command.
ProbeSource make_grid_source(Command command);
ProbeSource make_cubemap_source(Command command);
ProbeSource make_sh9_source();  // no options of their own
ProbeSource make_difmap_source();
ProbeSource make_environment_source();  // any image that no other source takes: comes last
ProbeSource make_scene_source(Command command);
ProbeSource make_fiv_source(Command command);

}  // namespace ivory
