// Options of `ivory bake grid` that are lists of a form of their own. All throw UsageError, which names the option.
#pragma once

#include <string>
#include <vector>

#include "grid/base/types.h"
#include "tracer/bake/field/grid_params.h"

namespace ivory {

// --dynamic: boxes "X0,Y0,Z0:X1,Y1,Z1" in the world; "none" alone is none.
std::vector<Imath::Box3d> parse_regions(const std::vector<std::string>& texts);

// --groups: "hall=Lamp*,Neon*"; `extras` alone is no rule.
std::vector<LightGroupRule> parse_groups(const std::vector<std::string>& texts);

// --direct-of: "area,sky".
DirectSources parse_direct(const std::string& text);

}  // namespace ivory
