// The environment map that a command works on, and the options that say which.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "grid/env/environment_image.h"
#include "grid/env/layout.h"
#include "grid/io/environment.h"
#include "tools/cli/options.h"

namespace ivory {

struct CommonOptions;

struct EnvironmentChoice {
  std::string path;     // empty: none
  std::string layout;   // empty: what the file says
  double turn_deg = 0;  // about +Y, counter-clockwise seen from above
};

// --layout NAME, read by load_environment_input().
Option add_layout_option(Command command, EnvironmentChoice& choice);
// --env IMAGE, --layout and --env-turn, in the help page's group `group` where that is not empty.
void add_environment_options(Command command, EnvironmentChoice& choice, const std::string& group = {});

struct EnvironmentInput {
  EnvironmentImage image;
  // environment (name without folder), environment_hash (of its bytes), environment_layout; where there is something to
  // say environment_turn_deg, environment_color_space, environment_layer, and all warnings as "assumptions"
  Metadata origin;
  std::vector<std::string> warnings;  // of load_environment_image(), not printed yet
};

// What was turned is a lat-long map. Throws Error as load_environment_image() does.
EnvironmentInput load_environment_input(const EnvironmentChoice& choice);
// The same for a command, which may share it with others (tools/cli/host.h).
EnvironmentInput load_environment_input(const EnvironmentChoice& choice, const CommonOptions& common);

// The turn that an asset or a scene of that metadata has its environment in; 0 where it says none.
double environment_turn_deg(const Metadata& metadata);

}  // namespace ivory
