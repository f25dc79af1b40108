#include "tracer/bake/field/contract/certificate.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "grid/field/lookup.h"
#include "tracer/bake/field/contract/direction.h"
#include "tracer/bake/field/contract/worst_places.h"
#include "tracer/render/guard_rays.h"

namespace ivory {
namespace {

constexpr std::size_t least_points = 16;
constexpr int reach_paths = 64;

struct Measured {
  std::vector<MeasuredPoint> points;
  std::vector<DomainPoint> dark;
  std::uint64_t next = 0;
};

void measure(const LitScene& lit, const IrradianceGrid& grid, const Domain& domain, std::size_t count, int paths,
             const CertificateParams& params, Measured& into) {
  TruePoints found = find_true_points(lit, domain, into.next, count, paths, params.truth);
  const std::size_t first = into.points.size();
  into.points.resize(first + found.lit.size());
  tbb::parallel_for(std::size_t(0), found.lit.size(), [&](std::size_t i) {
    MeasuredPoint& point = into.points[first + i];
    point.point = found.lit[i];
    point.reading = read_grid(grid, lit.intersector, point.point.at, params.lookup);
    point.sample = point_error(point.point, point.reading.e);
  });
  into.dark.insert(into.dark.end(), found.dark.begin(), found.dark.end());
  into.next = found.next;
}

void balance(std::vector<MeasuredPoint>& points) {
  std::vector<DomainPoint*> at;
  at.reserve(points.size());
  for (MeasuredPoint& p : points) at.push_back(&p.point.at);
  balance_weights(at);
  for (MeasuredPoint& p : points) p.sample.weight = p.point.at.weight;
}

std::vector<PointError> samples_of(const std::vector<MeasuredPoint>& points) {
  std::vector<PointError> samples;
  samples.reserve(points.size());
  for (const MeasuredPoint& p : points) samples.push_back(p.sample);
  return samples;
}

// Weighted mean over the points.
template <typename F>
double mean_over(const std::vector<MeasuredPoint>& points, const F& value) {
  double sum = 0;
  double weights = 0;
  for (const MeasuredPoint& p : points) {
    sum += p.sample.weight * value(p);
    weights += p.sample.weight;
  }
  return weights > 0 ? sum / weights : 0;
}

// Light read where none arrives, by the same look-ups.
double leaks_at(const std::vector<DomainPoint>& dark, const LitScene& lit, const IrradianceGrid& grid,
                const LookupParams& lookup) {
  if (dark.empty()) return 0;
  std::vector<double> squares(dark.size());
  tbb::parallel_for(std::size_t(0), dark.size(), [&](std::size_t i) {
    const V3d e = read_grid(grid, lit.intersector, dark[i], lookup).e;
    squares[i] = e.length2() / 3;
  });
  double sum = 0;
  for (const double square : squares) sum += square;
  return std::sqrt(sum / double(dark.size()));
}

std::string describe(const FieldCertificate& certificate, const Domain& domain, const LookupParams& lookup) {
  std::size_t on_surface = 0;
  for (const MeasuredPoint& p : certificate.points) on_surface += p.point.at.on_surface ? 1 : 0;
  const std::size_t in_space = certificate.points.size() - on_surface;
  std::string where;
  if (!domain.params().given.empty()) {
    where = fmt::format("{} given points", certificate.points.size());
  } else if (in_space == 0) {
    where = fmt::format("{} lit surface points", on_surface);
  } else if (on_surface == 0) {
    where = fmt::format("{} lit points of free space", in_space);
  } else {
    where =
        fmt::format("{} lit surface points, which count three quarters, and {} of free space", on_surface, in_space);
  }
  return fmt::format("RMS of E over {}, three channels, ÷ mean E there; read with guard {}, {}; {} paths a point",
                     where, std::string(name_of(lookup.guard)), std::string(name_of(lookup.interpolation)),
                     certificate.paths_a_point);
}

}  // namespace

TruePoints find_lit_points(const LitScene& lit, const Domain& domain, std::uint64_t first, std::size_t count,
                           const TruthParams& params) {
  TruePoints out;
  out.next = first;
  const bool given = !domain.params().given.empty();
  const std::uint64_t last = given ? domain.size() : first + 8 * std::uint64_t(count) + 256;
  constexpr std::uint64_t batch = 256;
  while (out.lit.size() < count && out.next < last) {
    const std::uint64_t size = std::min(batch, last - out.next);
    std::vector<DomainPoint> candidates(size);
    std::vector<char> reached(size);
    const std::uint64_t begin = out.next;
    tbb::parallel_for(std::uint64_t(0), size, [&](std::uint64_t i) {
      candidates[i] = domain.point(begin + i);
      reached[i] = given || (candidates[i].weight > 0 &&
                             light_reaches(lit, candidates[i].p, candidates[i].n, reach_paths, begin + i, params));
    });
    for (std::uint64_t i = 0; i < size && out.lit.size() < count; ++i) {
      ++out.next;
      if (reached[i] != 0) {
        out.lit.push_back({candidates[i], begin + i, {}});
      } else if (candidates[i].weight > 0) {
        out.dark.push_back(candidates[i]);
      }
    }
  }
  return out;
}

TruePoints find_true_points(const LitScene& lit, const Domain& domain, std::uint64_t first, std::size_t count,
                            int paths, const TruthParams& params) {
  TruePoints out = find_lit_points(lit, domain, first, count, params);
  tbb::parallel_for(std::size_t(0), out.lit.size(), [&](std::size_t i) {
    TruePoint& point = out.lit[i];
    point.truth = trace_truth(lit, point.at.p, point.at.n, paths, point.index, params);
  });
  return out;
}

Reading read_grid(const IrradianceGrid& grid, const Intersector& intersector, const DomainPoint& at,
                  const LookupParams& lookup) {
  Reading out;
  const Footprint footprint = lookup_footprint(grid, &intersector, at.p, at.n, lookup);
  out.e = V3d(irradiance(grid, footprint, at.n, lookup.reconstruction));
  const V3d error = V3d(irradiance_standard_error(grid, footprint)) * noise_of_standard_error;
  out.noise = error * error;
  out.unseen = footprint.count == 0;
  if (grid.basis == Basis::vectors && footprint.count > 0) {
    std::array<float, 36> moments{};
    for (std::size_t i = 0; i < std::size_t(footprint.count); ++i) {
      const float* m = grid.at(footprint.vertex[i]);
      for (std::size_t k = 0; k < moments.size(); ++k) moments[k] += footprint.weight[i] * m[k];
    }
    const IrradianceBracket bracket = irradiance_bracket(moments.data(), grid.frame.direction_to_local(at.n));
    out.bracket = mean_of(V3d(bracket.upper - bracket.lower));
  }
  out.e_by_planes = out.e;
  if (lookup.guard == Guard::rays && !grid.guard.empty()) {
    LookupParams planes = lookup;
    planes.guard = Guard::planes;
    out.e_by_planes = V3d(irradiance(grid, lookup_footprint(grid, at.p, at.n, planes), at.n, lookup.reconstruction));
  }
  return out;
}

PointError point_error(const TruePoint& point, const V3d& read) {
  const V3d off = read - point.truth.e;
  return {mean_of(off * off - point.truth.variance), mean_of(point.truth.e), point.at.weight};
}

std::optional<FieldCertificate> certify(const LitScene& lit, const IrradianceGrid& grid, const Domain& domain,
                                        const CertificateParams& params) {
  const bool given = !domain.params().given.empty();
  // A few points tell how the truth and the error vary; they are not counted.
  constexpr std::size_t trial_points = 128;
  constexpr int trial_paths = 256;
  Measured trial;
  if (!given) trial.next = params.first_point;
  measure(lit, grid, domain, trial_points, trial_paths, params, trial);
  const double mean_e = mean_over(trial.points, [](const MeasuredPoint& p) { return p.sample.truth; });
  if (trial.points.size() < std::min<std::size_t>(least_points, domain.size()) || trial.points.size() < 2 ||
      !(mean_e > 0))
    return std::nullopt;
  const double path_variance =
      trial_paths * mean_over(trial.points, [](const MeasuredPoint& p) { return mean_of(p.point.truth.variance); });
  const double floor = 0.25 * params.target * params.target * mean_e * mean_e;
  constexpr double least_share = 0.002;  // of mean E, what is resolved where nothing was asked for
  // By chance the trial may find far more than there is, and too few paths would then tell nothing of what there is.
  const MeasuredError guess = root_mean_square(samples_of(trial.points));
  const double surely = std::max(0.0, guess.error * guess.error - guess.square_standard_error);
  const double square = std::max({surely * mean_e * mean_e, floor, std::pow(least_share * mean_e, 2)});

  FieldCertificate out;
  constexpr double least_paths = 64;
  constexpr double most_paths = 65536;
  out.paths_a_point =
      int(std::clamp(best_paths(path_variance, square), least_paths, most_paths)) / truth_groups * truth_groups;
  Measured measured;
  if (!given) measured.next = trial.next;
  const auto affordable = [&](double points) {
    const double most = std::min(double(params.most_points), double(params.most_paths) / out.paths_a_point);
    return std::size_t(std::clamp(points, 1.0, std::max(most, 64.0)));
  };
  constexpr double first_points = 512;
  measure(lit, grid, domain, given ? domain.size() : affordable(first_points), out.paths_a_point, params, measured);
  if (!given) balance(measured.points);
  if (measured.points.size() < 2) return std::nullopt;
  out.interval = root_mean_square(samples_of(measured.points));
  out.mean_e_lux = mean_over(measured.points, [](const MeasuredPoint& p) { return p.sample.truth; });
  if (!(out.mean_e_lux > 0)) return std::nullopt;
  if (!given) {
    // Of the square: twice `precision` of it, or of that of half the target where the error is less.
    const double t = out.interval.error * out.interval.error;
    const double aim = 2 * params.precision * std::max(t, square / (mean_e * mean_e));
    const double have = double(measured.points.size());
    const std::size_t wanted = affordable(have * std::pow(out.interval.square_standard_error / aim, 2));
    if (wanted > measured.points.size()) {
      measure(lit, grid, domain, wanted - measured.points.size(), out.paths_a_point, params, measured);
    }
  }
  if (!given) balance(measured.points);
  out.interval = root_mean_square(samples_of(measured.points));
  out.mean_e_lux = mean_over(measured.points, [](const MeasuredPoint& p) { return p.sample.truth; });
  out.points = std::move(measured.points);
  out.dark_points = measured.dark.size();

  std::map<std::string, double> parts;
  const auto share = [&](double mean_square) { return std::sqrt(std::max(0.0, mean_square)) / out.mean_e_lux; };
  parts["noise"] = share(mean_over(out.points, [](const MeasuredPoint& p) { return mean_of(p.reading.noise); }));
  parts["unseen"] =
      share(mean_over(out.points, [](const MeasuredPoint& p) { return p.reading.unseen ? p.sample.squared : 0; }));
  if (params.directions && grid.light == StoredLight::indirect) {
    const DirectionErrors errors = direction_errors(lit, out.points, grid.finest_frame(), out.mean_e_lux, params.truth);
    out.direction_vectors = errors.vectors;
    out.direction_vectors9 = errors.vectors9;
    out.direction_sh9 = errors.sh9;
    const std::optional<double> own = grid.basis == Basis::vectors    ? out.direction_vectors
                                      : grid.basis == Basis::vectors9 ? out.direction_vectors9
                                      : grid.basis == Basis::sh9      ? out.direction_sh9
                                                                      : std::nullopt;
    if (own && params.lookup.reconstruction == Reconstruction::optimal) parts["direction"] = *own;
  }
  double rest = out.interval.error * out.interval.error;
  for (const auto& [name, part] : parts) rest -= part * part;
  parts["resolution"] = std::sqrt(std::max(0.0, rest));
  parts["leaks"] = leaks_at(measured.dark, lit, grid, params.lookup) / out.mean_e_lux;
  if (params.lookup.guard == Guard::rays && !grid.guard.empty()) {
    parts["planes"] = share(mean_over(
        out.points, [](const MeasuredPoint& p) { return (p.reading.e_by_planes - p.reading.e).length2() / 3; }));
  }
  out.worst = worst_places(lit, out.points, grid, out.mean_e_lux);
  out.summary = {
      params.target,   out.interval.error, out.interval.low, out.interval.high, describe(out, domain, params.lookup),
      std::move(parts)};
  return out;
}

std::string text_of(const WorstPlace& place) {
  return fmt::format("{:.7g} {:.7g} {:.7g}, {}: {:.3g} lux read for {:.3g}, {:+.2g} % of mean E; {}", place.p_world.x,
                     place.p_world.y, place.p_world.z,
                     place.on_surface
                         ? fmt::format("on a surface of normal {:.2g} {:.2g} {:.2g}", place.n.x, place.n.y, place.n.z)
                         : "in free space",
                     place.read_lux, place.e_lux, 100 * place.off, place.cause);
}

void keep_field_certificate(const FieldCertificate& certificate, Metadata& metadata) {
  keep_certificate(certificate.summary, metadata);
  std::string text;
  for (const WorstPlace& place : certificate.worst) {
    if (!text.empty()) text += '\n';
    text += text_of(place);
  }
  if (!text.empty()) metadata["certificate_worst"] = text;
}

}  // namespace ivory
