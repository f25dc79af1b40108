// From what pilot bakes showed to the spacing and the photons that meet an error at the least cost.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace ivory {

// What one pilot showed: errors are shares of mean E.
struct PilotErrors {
  double spacing_m = 0;  // geometric mean of the three axes
  double photons = 0;
  double bias = 0;   // at any number of photons, direction included
  double noise = 0;  // at that number
};

// error^2 = direction^2 + resolution^2 + noise^2, the basis' share constant,
//   resolution = at_1m * h^order,  noise^2 = noise_photons / (photons h^2):
// a cell is met by photons in proportion to h^2, each of which counts 1 / h^2. Bias falls by 0.5 to 0.7 for each
// halving of the spacing in the scenes measured: order 0.5 to 1. Pilots that are too coarse to have any order at all
// say anything, so that it is kept within 0.5 and 1.25.
struct ErrorModel {
  double direction = 0;
  double at_1m = 0;
  double order = 0.75;
  double noise_photons = 0;

  double bias(double spacing_m) const;
  double noise(double spacing_m, double photons) const;
  double error(double spacing_m, double photons) const;
};

// Through the finest pilot, with the order that the two finest show. At least one; coarsest first.
ErrorModel fit_errors(const std::vector<PilotErrors>& pilots, double direction);

// What a bake costs on one thread, in seconds of the machine that it was measured on (a core of 2020, room with boxes
// at 16 to 64 vertices): plans are the same everywhere because they are made by these, not by a clock.
struct CostModel {
  double a_vertex_s = 16e-6;            // to find what it sees and to fit its guard
  double a_photon_s = 1.2e-6;           // to trace
  double a_photon_and_layer_s = 40e-9;  // to deposit, for each vertex along the longest side

  double seconds(double vertices, double layers, double photons) const {
    return a_vertex_s * vertices + photons * (a_photon_s + a_photon_and_layer_s * layers);
  }
};

// A grid that could be baked.
struct Spacing {
  double spacing_m = 0;
  double vertices = 0;
  double layers = 0;           // vertices along the longest side
  double photons_at_hand = 0;  // that a pilot has left there already
};

struct PlanLimits {
  double aim = 0;                                     // error to be reached, a share
  double least_photons = 20'000;                      // fewer are never worth it
  std::optional<double> photons = std::nullopt;       // fixed by hand
  std::optional<double> most_seconds = std::nullopt;  // of the cost model's machine
};

struct Plan {
  std::size_t spacing = 0;  // which of those offered
  std::uint64_t photons = 0;
  double bias = 0;  // predicted
  double noise = 0;
  double error = 0;
  double seconds = 0;  // of the cost model's machine
  bool meets = false;  // is `aim` reached within the limits?
};

// The cheapest of the spacings that reaches the aim, with as many photons as it then needs; where none does, the
// cheapest that comes within a tenth of the least error: the rest is not worth any price. `spacings` is not empty.
Plan choose_plan(const std::vector<Spacing>& spacings, const ErrorModel& errors, const CostModel& costs,
                 const PlanLimits& limits);

}  // namespace ivory
