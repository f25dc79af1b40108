// The points that a plan is made by: E is known there, and grids are held against it.
#pragma once

#include <vector>

#include "tracer/bake/field/contract/certificate.h"

namespace ivory {

struct PlanningPoints {
  std::vector<TruePoint> lit;
  double mean_e_lux = 0;         // 0: light reaches too little of the domain to plan by
  double path_seconds = 0;       // that a path to them took, by the clock
  double certificate_paths = 0;  // that measuring an error of the target is going to take
};

// Points of the domain (of given ones, all) that no certificate is measured at. The truth at them is traced as long as
// their own error, were it at the target, asks for.
PlanningPoints find_planning_points(const LitScene& lit, const Domain& domain, double target, const TruthParams& truth);

// Shares of mean E.
struct ReachedError {
  double error = 0;
  double noise = 0;  // photon noise, a part of it
};
ReachedError error_at(const PlanningPoints& points, const IrradianceGrid& grid, const Intersector& intersector,
                      const LookupParams& lookup);

}  // namespace ivory
