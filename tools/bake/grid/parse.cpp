#include "tools/bake/grid/parse.h"

#include <sstream>

#include "grid/base/error.h"
#include "tools/cli/box.h"
#include "tools/cli/common.h"

namespace ivory {

std::vector<Imath::Box3d> parse_regions(const std::vector<std::string>& texts) {
  std::vector<Imath::Box3d> regions;
  if (texts == std::vector<std::string>{"none"}) return regions;
  for (const std::string& text : texts)
    regions.push_back(parse_box("--dynamic", text, "none or a box X0,Y0,Z0:X1,Y1,Z1"));
  return regions;
}

std::vector<LightGroupRule> parse_groups(const std::vector<std::string>& texts) {
  std::vector<LightGroupRule> rules;
  for (const std::string& text : texts) {
    if (text == "extras") continue;
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
      throw UsageError("--groups: '" + text + "' is neither GROUP=PATTERN,... nor extras");
    LightGroupRule rule{text.substr(0, equals), {}};
    std::istringstream patterns(text.substr(equals + 1));
    for (std::string pattern; std::getline(patterns, pattern, ',');) rule.patterns.push_back(pattern);
    rules.push_back(std::move(rule));
  }
  return rules;
}

DirectSources parse_direct(const std::string& text) {
  DirectSources direct;
  std::istringstream names(text);
  for (std::string name; std::getline(names, name, ',');) {
    bool* const source = name == "punctual" ? &direct.punctual
                         : name == "area"   ? &direct.area
                         : name == "sky"    ? &direct.sky
                                            : nullptr;
    if (source == nullptr) throw UsageError("--direct-of: '" + name + "' is none of punctual, area, sky");
    *source = true;
  }
  if (!direct) throw UsageError("--direct-of: names no kind; give some of punctual, area, sky");
  return direct;
}

}  // namespace ivory
