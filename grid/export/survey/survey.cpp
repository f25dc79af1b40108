#include "grid/export/survey/survey.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "grid/field/lookup.h"

namespace ivory {

namespace {

double channel_mean(const Rgb& e) { return (double(e.x) + e.y + e.z) / 3; }

}  // namespace

double off_by(const SurveyPoint& point, double mean_lux) {
  return mean_lux > 0 ? (channel_mean(point.shown) - channel_mean(point.known)) / mean_lux : 0;
}

ReaderSurvey make_survey(std::vector<SurveyPoint> points, float apart_m) {
  ReaderSurvey survey;
  survey.points = std::move(points);
  const auto count = double(survey.points.size());
  if (survey.points.empty()) return survey;
  for (const SurveyPoint& point : survey.points) survey.mean_lux += channel_mean(point.known) / count;
  std::vector<double> off;
  double squares = 0;
  for (const SurveyPoint& point : survey.points) {
    const double share = off.emplace_back(off_by(point, survey.mean_lux));
    squares += share * share;
    if (share > survey_tolerance) survey.too_bright += 1 / count;
    if (share < -survey_tolerance) survey.too_dark += 1 / count;
  }
  survey.rms = std::sqrt(squares / count);
  std::vector<std::size_t> order(off.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return std::abs(off[a]) > std::abs(off[b]); });
  for (const std::size_t i : order) {
    if (survey.worst.size() == survey_places || off[i] == 0) break;
    const SurveyPoint& point = survey.points[i];
    const bool is_apart = std::ranges::all_of(
        survey.worst, [&](const SurveyPlace& place) { return (place.at.p - point.at.p).length() >= apart_m; });
    if (is_apart) survey.worst.push_back({point.at, channel_mean(point.shown), channel_mean(point.known), off[i]});
  }
  return survey;
}

ReaderSurvey survey_planes(const IrradianceGrid& grid, const ProbeReader& reader, int points, float apart_m,
                           std::uint64_t seed) {
  std::vector<SurveyPoint> found;
  LookupParams lookup = export_lookup(grid);
  lookup.nudge_voxels = LookupParams().nudge_voxels;
  constexpr std::uint64_t tries_a_point = 200;
  for (std::uint64_t i = 0; !grid.guard.empty() && i < std::uint64_t(points) * tries_a_point; ++i) {
    if (found.size() == std::size_t(points)) break;
    const std::optional<SurfacePoint> at = plane_point(grid, seed, i);
    if (!at) continue;
    const Footprint footprint = lookup_footprint(grid, at->p, at->n, lookup);
    if (footprint.count > 0)
      found.push_back({*at, reader(at->p, at->n), irradiance(grid, footprint, at->n, Reconstruction::optimal)});
  }
  return make_survey(std::move(found), apart_m);
}

}  // namespace ivory
