#include "tracer/bake/field/contract/planning_points.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <tbb/parallel_for.h>

namespace ivory {
namespace {

// Points that plans are made by are others than those that certificates are measured at.
constexpr std::uint64_t planning_points_from = std::uint64_t(1) << 48U;
// Few points hold most of a grid's square error: where paths are few, many points are cheap.
constexpr double least_points = 384;
constexpr double most_points = 2048;
constexpr double paths_of_all = 1'200'000;

}  // namespace

PlanningPoints find_planning_points(const LitScene& lit, const Domain& domain, double target,
                                    const TruthParams& truth) {
  constexpr std::size_t trial = 96;
  constexpr int trial_paths = 64;
  constexpr double most_paths = 3072;
  const auto start = std::chrono::steady_clock::now();
  PlanningPoints points;
  const bool given = !domain.params().given.empty();
  const std::uint64_t first = given ? 0 : planning_points_from;
  const TruePoints few = find_true_points(lit, domain, first, given ? domain.size() : trial, trial_paths, truth);
  double variance = 0;
  double e = 0;
  double weights = 0;
  for (const TruePoint& point : few.lit) {
    variance += point.at.weight * mean_of(point.truth.variance) * trial_paths;
    e += point.at.weight * mean_of(point.truth.e);
    weights += point.at.weight;
  }
  if (few.lit.size() < std::min<std::size_t>(16, domain.size()) || !(e > 0)) return points;
  e /= weights;
  variance /= weights;
  const double best = best_paths(variance, std::pow(target * e, 2));
  const int paths = int(std::clamp(best, 64.0, most_paths));
  const auto count = std::size_t(std::clamp(paths_of_all / paths, least_points, most_points));
  points.lit = find_true_points(lit, domain, given ? 0 : few.next, given ? domain.size() : count, paths, truth).lit;
  weights = 0;
  for (const TruePoint& point : points.lit) {
    points.mean_e_lux += point.at.weight * mean_of(point.truth.e);
    weights += point.at.weight;
  }
  points.mean_e_lux /= weights;
  points.path_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() /
                        (double(points.lit.size()) * paths + double(few.lit.size()) * trial_paths);
  constexpr double certificate_points = 1024;
  points.certificate_paths = certificate_points * std::clamp(best, 64.0, 32e6 / certificate_points);
  return points;
}

ReachedError error_at(const PlanningPoints& points, const IrradianceGrid& grid, const Intersector& intersector,
                      const LookupParams& lookup) {
  std::vector<PointError> samples(points.lit.size());
  std::vector<double> noise(points.lit.size());
  tbb::parallel_for(std::size_t(0), points.lit.size(), [&](std::size_t i) {
    const Reading reading = read_grid(grid, intersector, points.lit[i].at, lookup);
    samples[i] = point_error(points.lit[i], reading.e);
    noise[i] = mean_of(reading.noise);
  });
  double squares = 0;
  double weights = 0;
  for (std::size_t i = 0; i < points.lit.size(); ++i) {
    squares += points.lit[i].at.weight * noise[i];
    weights += points.lit[i].at.weight;
  }
  return {root_mean_square(samples).error, std::sqrt(squares / weights) / points.mean_e_lux};
}

}  // namespace ivory
