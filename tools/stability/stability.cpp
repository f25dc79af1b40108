#include "tools/stability/stability.h"

#include "grid/base/error.h"

namespace ivory {

std::vector<StabilityCase> stability_cases() {
  std::vector<StabilityCase> all;
  for (const auto& cases :
       {stability_grid_cases(), stability_wall_cases(), stability_light_cases(), stability_range_cases(),
        stability_fiv_cases(), stability_cubemap_cases(), stability_lobe_cases()})
    all.insert(all.end(), cases.begin(), cases.end());
  return all;
}

StabilityCase stability_case(std::string_view name) {
  for (const StabilityCase& known : stability_cases()) {
    if (known.name == name) return known;
  }
  throw ParameterError("case", "'" + std::string(name) + "' is unknown; --list names all");
}

}  // namespace ivory
