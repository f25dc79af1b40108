// Lights by groups, for bakes that keep apart what each brings: sun, sky, hall, emergency ...
#pragma once

#include <string>
#include <vector>

#include "tracer/lights/lights.h"

namespace ivory {

// Which lights a group takes.
struct LightGroupRule {
  std::string name;  // of the group; several rules may add to one
  // Names of nodes, of the light's own or of one above it, patterns as a shell has them (*, ?, [a-c]);
  // @environment, the environment map; @suns, all directional lights.
  std::vector<std::string> patterns;
};

struct LightGroups {
  std::vector<std::string> names;
  std::vector<int> of_light;  // [light], as Lights numbers them: its group
};

// What no rule takes goes by extras.ivory_group of its node or the nearest one above, and to the group `rest` where
// there is none either; a light goes to the first rule that takes it. Groups stand in the order of the rules, then of
// their lights, and each has a light. Throws ParameterError ("groups") for a rule that takes no light, and for names
// that are not letters, digits and '_', at most 64 of them.
LightGroups make_light_groups(const Lights& lights, const Scene& scene, const std::vector<LightGroupRule>& rules);

}  // namespace ivory
