// The stability suite: every place where a method is known to fail, swept through the failure. A case measures errors
// against a closed form or a slow twin; its bounds are what the tests hold it to.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ivory {

struct StabilityParams {
  bool quick = false;  // fewer points and samples: what the tests run. Bounds hold either way
};

struct StabilityPoint {
  std::string series;
  double x = 0;
  double error = 0;             // in what the case's y_label says
  std::optional<double> bound;  // error may not be larger; none for series that only show the failure
};

// One plot and one sentence: what fails, where, and what to do.
struct StabilityCase {
  std::string_view name;  // of the command line
  std::string_view title;
  std::string_view sentence;
  std::string_view x_label;
  std::string_view y_label;
  bool log_x = false;
  bool log_y = true;
  std::vector<StabilityPoint> (*run)(const StabilityParams& params) = nullptr;
};

// All cases in a fixed order; names are unique.
std::vector<StabilityCase> stability_cases();

// Throws ParameterError for a name that no case has.
StabilityCase stability_case(std::string_view name);

// By subject, for stability_cases().
std::vector<StabilityCase> stability_grid_cases();
std::vector<StabilityCase> stability_wall_cases();
std::vector<StabilityCase> stability_light_cases();
std::vector<StabilityCase> stability_range_cases();
std::vector<StabilityCase> stability_fiv_cases();
std::vector<StabilityCase> stability_cubemap_cases();
std::vector<StabilityCase> stability_lobe_cases();

}  // namespace ivory
