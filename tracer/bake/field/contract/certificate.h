// The error of a grid of irradiance vectors, measured against path tracing at points that had no part in how the grid
// was made, and taken apart by cause.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "grid/base/certificate.h"
#include "grid/base/measured_error.h"
#include "grid/field/irradiance_grid.h"
#include "tracer/bake/field/contract/domain.h"
#include "tracer/bake/field/contract/truth.h"

namespace ivory {

// A point of the domain that light reaches, and E there.
struct TruePoint {
  DomainPoint at;
  std::uint64_t index = 0;  // in the domain
  Truth truth;
};

struct TruePoints {
  std::vector<TruePoint> lit;
  std::vector<DomainPoint> dark;  // that no path brought light to
  std::uint64_t next = 0;         // the domain's point after the last that was looked at
};

// The next `count` points of the domain from number `first` on that light reaches (one of 64 paths of their own met
// light; of given points, all), their truth left out. Fewer where light is hard to find: after 8 candidates for each
// point wanted it gives up.
TruePoints find_lit_points(const LitScene& lit, const Domain& domain, std::uint64_t first, std::size_t count,
                           const TruthParams& params);

// The same with E from `paths` paths each.
TruePoints find_true_points(const LitScene& lit, const Domain& domain, std::uint64_t first, std::size_t count,
                            int paths, const TruthParams& params);

// What a grid says at such a point.
struct Reading {
  V3d e{0, 0, 0};            // lux
  V3d noise{0, 0, 0};        // variance of e by photon noise, lux^2
  bool unseen = false;       // no vertex sees the point: it reads 0
  double bracket = 0;        // width of the bounds on E that the six vectors give, lux, mean of the channels; else 0
  V3d e_by_planes{0, 0, 0};  // by the stored guard; as e where there is none
};

// irradiance_standard_error() takes a grid's noise a quarter too high, on the whole: the spread over seeds was 0.71 to
// 0.81 of it.
inline constexpr double noise_of_standard_error = 0.76;

// As LookupParams say, at the point's own geometric normal. Rays need the scene's intersector.
Reading read_grid(const IrradianceGrid& grid, const Intersector& intersector, const DomainPoint& at,
                  const LookupParams& lookup);

// Square error at a point, the truth's own noise taken off, and the truth: means over the channels, lux^2 and lux.
PointError point_error(const TruePoint& point, const V3d& read);

struct CertificateParams {
  double target = 0;  // 0: nothing was asked for
  LookupParams lookup{.guard = Guard::rays};
  TruthParams truth{};
  std::uint64_t first_point = 0;  // of the domain; those before it had their part in something else
  double precision = 0.08;        // standard error aimed at, as a share of the error (or of half the target)
  std::size_t most_points = 3072;
  bool directions = true;  // measure what the basis makes of directions, too
  std::uint64_t most_paths = 32'000'000;
};

struct MeasuredPoint {
  TruePoint point;
  Reading reading;
  PointError sample;
};

// Where a grid is worst.
struct WorstPlace {
  V3d p_world;
  V3f n;
  bool on_surface = true;
  double off = 0;    // (E read - E) ÷ mean E over the domain, channels averaged: positive is too bright
  double e_lux = 0;  // truth, mean of the channels
  double read_lux = 0;
  std::string cause;  // likely
};

struct FieldCertificate {
  Certificate summary;
  MeasuredError interval;
  double mean_e_lux = 0;
  // Directional error of bases, measured at some of the points with all else exact: share of mean E.
  std::optional<double> direction_vectors, direction_vectors9, direction_sh9;
  std::vector<MeasuredPoint> points;
  std::size_t dark_points = 0;
  int paths_a_point = 0;
  std::vector<WorstPlace> worst;  // the worst first, no two within two voxels or a twentieth of the grid
};

// Measures. The error is the root of the mean over points and channels of (E read - E)^2, the truth's noise taken off,
// divided by the mean of E over points and channels. Its parts are shares of mean E likewise; the first four make it
// up, as sums of squares, the others stand beside it:
//   noise       photon noise
//   direction   what the basis makes of the light of all directions (bases vectors, vectors9, sh9; indirect light only)
//   unseen      points that no vertex sees
//   resolution  the rest: light that varies between vertices
//   leaks       light read at points of the domain that none reaches, over those
//   planes      what reading by the stored planes changes against reading by rays
// Nothing where light reaches fewer than 16 of the points tried, or nothing of the truth is above 0. Neither threads
// nor what was measured before matter to the result.
std::optional<FieldCertificate> certify(const LitScene& lit, const IrradianceGrid& grid, const Domain& domain,
                                        const CertificateParams& params);

// keep_certificate(), and certificate_worst: a line a place.
void keep_field_certificate(const FieldCertificate& certificate, Metadata& metadata);
// "at X Y Z: 12 lux read for 9 (+14 % of mean E), on a surface; likely contact"
std::string text_of(const WorstPlace& place);

}  // namespace ivory
