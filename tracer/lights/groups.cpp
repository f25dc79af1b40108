#include "tracer/lights/groups.h"

#include <algorithm>

#include <fnmatch.h>

#include "grid/base/error.h"

namespace ivory {

namespace {

constexpr std::size_t most_name_letters = 64;

void check_name(const std::string& name) {
  const bool plain = std::ranges::all_of(name, [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  });
  if (name.empty() || name.size() > most_name_letters || !plain) {
    throw ParameterError("groups", "'" + name + "' is no name of a group: take up to " +
                                       std::to_string(most_name_letters) + " letters, digits and '_'");
  }
}

bool takes(const std::string& pattern, const Lights& lights, const Scene& scene, std::size_t light) {
  if (pattern == "@environment") return lights.is_environment(light);
  if (pattern == "@suns")
    return light < scene.lights.size() && std::holds_alternative<DirectionalLight>(scene.lights[light]);
  for (int node = lights.node_of(light); node != no_index; node = scene.nodes[std::size_t(node)].parent) {
    if (fnmatch(pattern.c_str(), scene.nodes[std::size_t(node)].name.c_str(), 0) == 0) return true;
  }
  return false;
}

std::string stored_group(const Lights& lights, const Scene& scene, std::size_t light) {
  for (int node = lights.node_of(light); node != no_index; node = scene.nodes[std::size_t(node)].parent) {
    const std::string& group = scene.nodes[std::size_t(node)].light_group;
    if (!group.empty()) return group;
  }
  return "rest";
}

}  // namespace

LightGroups make_light_groups(const Lights& lights, const Scene& scene, const std::vector<LightGroupRule>& rules) {
  LightGroups groups;
  const auto index_of = [&](const std::string& name) {
    const auto found = std::ranges::find(groups.names, name);
    if (found != groups.names.end()) return int(found - groups.names.begin());
    check_name(name);
    groups.names.push_back(name);
    return int(groups.names.size()) - 1;
  };
  for (const LightGroupRule& rule : rules) index_of(rule.name);

  std::vector<bool> used(rules.size(), false);
  for (std::size_t light = 0; light < lights.count(); ++light) {
    const auto rule = std::ranges::find_if(rules, [&](const LightGroupRule& r) {
      return std::ranges::any_of(r.patterns, [&](const std::string& p) { return takes(p, lights, scene, light); });
    });
    if (rule != rules.end()) used[std::size_t(rule - rules.begin())] = true;
    groups.of_light.push_back(index_of(rule != rules.end() ? rule->name : stored_group(lights, scene, light)));
  }
  for (std::size_t i = 0; i < rules.size(); ++i) {
    if (!used[i]) {
      throw ParameterError("groups",
                           "'" + rules[i].name + "' has no light: none matches, or an earlier group has them");
    }
  }
  return groups;
}

}  // namespace ivory
