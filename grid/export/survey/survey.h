// What a reader of probes shows place by place on surfaces, against what is known there.
#pragma once

#include <vector>

#include "grid/export/reader.h"
#include "grid/export/survey/plane_points.h"

namespace ivory {

struct SurveyPoint {
  SurfacePoint at;
  Rgb shown{0, 0, 0};  // E in lux by the reader
  Rgb known{0, 0, 0};  // by a look-up with a guard
};

// Shares are of mean E: that known at all points, mean of channels.
struct SurveyPlace {
  SurfacePoint at;
  double shown_lux = 0;
  double known_lux = 0;
  double off = 0;  // (shown - known) / mean
};
struct ReaderSurvey {
  std::vector<SurveyPoint> points;
  double mean_lux = 0;
  double rms = 0;                  // of the differences
  double too_bright = 0;           // share of the points that show more than survey_tolerance too much
  double too_dark = 0;             // and too little
  std::vector<SurveyPlace> worst;  // the farthest off first, at most survey_places
};

inline constexpr double survey_tolerance = 0.1;  // of mean E
inline constexpr std::size_t survey_places = 8;

// Of points that are spread evenly over surfaces. Worst places are at least `apart_m` from each other.
ReaderSurvey make_survey(std::vector<SurveyPoint> points, float apart_m);

// At up to `points` points of the planes that the grid's guard knows (plane_point()), against its look-up by them; none
// for a grid without guard. The same for the same seed.
ReaderSurvey survey_planes(const IrradianceGrid& grid, const ProbeReader& reader, int points, float apart_m,
                           std::uint64_t seed);

// (shown - known) / mean of a point, of channels' means; 0 where the mean is 0.
double off_by(const SurveyPoint& point, double mean_lux);

}  // namespace ivory
