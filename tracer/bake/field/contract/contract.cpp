#include "tracer/bake/field/contract/contract.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "grid/base/error.h"
#include "grid/field/resolve.h"
#include "tracer/bake/field/contract/direction.h"

namespace ivory {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double mean_of(const V3d& rgb) { return (rgb.x + rgb.y + rgb.z) / 3; }

// Points that plans are made by are others than those that certificates are measured at.
constexpr std::uint64_t planning_points_from = std::uint64_t(1) << 48U;
constexpr std::uint64_t points_a_round = std::uint64_t(1) << 36U;
constexpr std::size_t planning_points = 384;
constexpr int coarsest_layers = 8;  // of the first pilot
// A pilot's noise is to be no more than its bias, or than what is aimed at: then the bias is told from it.
constexpr double least_pilot_photons = 64'000;
constexpr double least_pilot_photons_a_vertex = 8;
constexpr double most_pilot_photons_a_vertex = 256;
constexpr int most_rounds = 4;
// Predictions are off by a tenth as a rule, and so is the measurement of what was reached.
constexpr double aim_of_target = 0.88;

// What a bake by resolution alone does unless it is told otherwise (baker.cpp).
constexpr double usual_layers = 32;
constexpr double usual_photons_a_vertex = 256;
constexpr double least_usual_photons = 1e6;

double spacing_of(const GridFrame& frame) {
  const V3f& h = frame.spacing_m;
  return std::cbrt(double(h.x) * h.y * h.z);
}

double layers_of(const GridFrame& frame) { return std::max({frame.size.x, frame.size.y, frame.size.z}); }

double longest_m(const GridFrame& frame) {
  const V3f extent = V3f(frame.size) * frame.spacing_m;
  return std::max({extent.x, extent.y, extent.z});
}

// The box that is asked for, cut into as few cells as may be.
GridFrame covering_frame(const Scene& scene, GridBakeParams params) {
  params.voxel_size_m.reset();
  params.resolution = V3i(2, 2, 2);
  return default_frame(scene, params);
}

GridAccumulator merged(GridAccumulator first, GridAccumulator second) {
  std::vector<GridAccumulator> two;
  two.push_back(std::move(first));
  two.push_back(std::move(second));
  return merge(std::move(two), {"the photons at hand", "those added to them"});
}

// Spacings side by side, each twice the one before, as many as leave the coarsest at least 12 vertices along the
// longest side: fine where surfaces are, coarse in the open. Only sums of the track estimator can be kept so.
int levels_for(double layers, Estimator estimator) {
  constexpr double coarsest = 12;
  constexpr int most = 6;
  if (estimator != Estimator::track) return 1;
  return std::clamp(1 + int(std::floor(std::log2(layers / coarsest))), 1, most);
}

struct Candidate {
  GridBakeParams bake;
  Lattice lattice;

  const GridFrame& finest() const { return lattice.finest_frame(); }
};

class Planner {
 public:
  Planner(const LitScene& lit, const ContractParams& params)
      : lit_(lit),
        params_(params),
        cover_(covering_frame(*lit.scene, params.bake)),
        domain_(*lit.scene, {.frame = cover_,
                             .kind = params.domain,
                             .dynamic_regions = params.bake.dynamic_regions,
                             .given = params.points,
                             .seed = params.bake.seed}) {
    truth_.max_bounces = params.bake.max_bounces;
    truth_.indirect_only = !params.bake.include_direct;
    truth_.seed = params.bake.seed;
  }

  GridPlan plan() {
    find_points();
    make_candidates();
    if (mean_e_ <= 0) return unknown_plan();
    const bool fixed = candidates_.size() == 1;
    double layers = fixed ? std::min(double(coarsest_layers), layers_of(candidates_[0].finest())) : coarsest_layers;
    pilot(layers);
    if (!fixed || layers * 2 <= layers_of(candidates_[0].finest())) pilot(layers *= 2);
    measure_direction();
    choose();
    // Extrapolating by more than 1.8 is not to be trusted; a pilot of twice the resolution is to cost a quarter of the
    // bake at most.
    constexpr double far = 1.8;
    constexpr double worth = 0.25;
    for (;;) {
      const GridFrame& chosen = candidates_[chosen_.spacing].finest();
      const double spacing_m = longest_m(cover_) / (2 * layers);
      if (spacing_of(chosen) * far >= 2 * spacing_m) break;
      if (pilot_seconds(2 * layers) > worth * chosen_.seconds) break;
      pilot(layers *= 2);
      if (stalls()) stop_refining();
      choose();
    }
    return describe();
  }

  ContractResult bake() {
    ContractResult out;
    out.plan = plan();
    out.by_clock = params_.most_seconds.has_value();
    if (mean_e_ <= 0) {
      GridBakeParams bake = params_.bake;
      bake.photons = out.plan.photons;
      out.sums = bake_grid_sums(lit_, bake);
      return out;
    }
    for (out.rounds = 1;; ++out.rounds) {
      bake_chosen();
      // The points of the plan see at no cost what is plainly not enough: certificates are for what may be.
      if (out.rounds < most_rounds && improve(error_at_planning_points())) continue;
      note(fmt::format("measuring the error against path tracing"));
      out.certificate = certificate(out.rounds);
      if (!out.certificate) break;
      const FieldCertificate& measured = *out.certificate;
      const auto part = [&](const char* name) {
        return measured.summary.parts.contains(name) ? measured.summary.parts.at(name) : 0.0;
      };
      if (out.rounds == most_rounds || !improve({measured.interval.error, part("noise")})) break;
    }
    if (out.certificate && out.certificate->interval.error > params_.target && out.plan.limited_by.empty()) {
      const std::string limit = what_limits();
      out.plan.limited_by = limit.empty() ? "predictions that promised too much" : limit;
    }
    out.sums = std::move(*sums_);
    return out;
  }

 private:
  void note(const std::string& line) const {
    if (params_.note) params_.note(line);
  }

  // The truth at them is traced as long as their own error, were it at the target, asks for.
  void find_points() {
    constexpr std::size_t trial = 96;
    constexpr int trial_paths = 64;
    constexpr double spread_of_squares = 9;
    constexpr double most_paths = 3072;
    const auto start = Clock::now();
    const bool given = !params_.points.empty();
    const std::uint64_t first = given ? 0 : planning_points_from;
    const TruePoints few = find_true_points(lit_, domain_, first, given ? domain_.size() : trial, trial_paths, truth_);
    double variance = 0;
    double e = 0;
    double weights = 0;
    for (const TruePoint& point : few.lit) {
      variance += point.at.weight * mean_of(point.truth.variance) * trial_paths;
      e += point.at.weight * mean_of(point.truth.e);
      weights += point.at.weight;
    }
    if (few.lit.size() < std::min<std::size_t>(16, domain_.size()) || !(e > 0)) return;
    e /= weights;
    variance /= weights;
    const double best = std::sqrt(2 / spread_of_squares) * variance / std::pow(params_.target * e, 2);
    const int paths = int(std::clamp(best, 64.0, most_paths));
    points_ =
        find_true_points(lit_, domain_, given ? 0 : few.next, given ? domain_.size() : planning_points, paths, truth_)
            .lit;
    weights = 0;
    for (const TruePoint& point : points_) {
      mean_e_ += point.at.weight * mean_of(point.truth.e);
      weights += point.at.weight;
    }
    mean_e_ /= weights;
    path_seconds_ = seconds_since(start) / (double(points_.size()) * paths + double(few.lit.size()) * trial_paths);
    constexpr double certificate_points = 1024;
    certificate_paths_ = certificate_points * std::clamp(best, 64.0, 32e6 / certificate_points);
  }

  // Do two halvings take less than a tenth off the bias each? Then something else than the spacing makes it, and finer
  // vertices would only cost.
  bool stalls() const {
    constexpr double worth = 0.9;
    const std::size_t n = pilots_.size();
    return n >= 3 && pilots_[n - 1].bias > worth * pilots_[n - 2].bias &&
           pilots_[n - 2].bias > worth * pilots_[n - 3].bias;
  }

  void stop_refining() {
    if (candidates_.size() == 1) return;
    const double finest = 0.99 * pilots_.back().spacing_m;
    std::erase_if(candidates_, [&](const Candidate& c) { return spacing_of(c.finest()) < finest; });
    limited_by_ = "an error that does not fall with the spacing";
  }

  // Spacings a quarter of an octave apart, from the first pilot's down to what memory holds; the one that is given,
  // where one is.
  void make_candidates() {
    const GridBakeParams& asked = params_.bake;
    if (asked.resolution || asked.voxel_size_m || asked.frame) {
      candidates_ = {{asked, default_lattice(*lit_.scene, asked)}};
      return;
    }
    const double limit = memory_limit_bytes(asked);
    for (int quarter = 0;; ++quarter) {
      Candidate c{asked, {}};
      const double layers = coarsest_layers * std::exp2(quarter / 4.0);
      constexpr double hair = 1 + 1e-6;  // less than one voxel over
      c.bake.voxel_size_m = float(longest_m(cover_) * hair / layers);
      c.bake.levels = levels_for(layers, asked.estimator);
      try {
        c.lattice = default_lattice(*lit_.scene, c.bake);
      } catch (const ParameterError&) {
        limited_by_ = "the number of vertices that a grid may have";
        break;
      } catch (const Error&) {
        limited_by_ = fmt::format("memory of {:.3g} GiB", limit / 1073741824.0);
        break;
      }
      if (grid_memory_bytes(c.lattice, c.bake, 1) > limit) {
        limited_by_ = fmt::format("memory of {:.3g} GiB", limit / 1073741824.0);
        break;
      }
      candidates_.push_back(c);
    }
    if (candidates_.empty()) {  // even the coarsest is too much: says so by itself
      const Lattice usual = default_lattice(*lit_.scene, asked);
      check_grid_memory(*lit_.scene, usual, asked);
      candidates_ = {{asked, usual}};
    }
  }

  double pilot_photons(const Lattice& lattice) const {
    const double vertices = double(lattice.vertex_count());
    const double least = std::max(least_pilot_photons, least_pilot_photons_a_vertex * vertices);
    if (pilots_.empty()) return least;
    const ErrorModel model = fit_errors(pilots_, 0);
    const double spacing_m = spacing_of(lattice.finest_frame());
    const double noise = std::max(model.bias(spacing_m), aim_of_target * params_.target);
    const double photons = model.noise_photons / std::pow(noise * spacing_m, 2);
    return std::clamp(photons, least, std::max(least, most_pilot_photons_a_vertex * vertices));
  }

  GridBakeParams pilot_params(double layers) const {
    GridBakeParams bake = params_.bake;
    bake.progress = nullptr;
    bake.pilot_progress = nullptr;
    if (candidates_.size() == 1 && layers_of(candidates_[0].finest()) <= layers) {
      bake.lattice = candidates_[0].lattice;
      return bake;
    }
    bake.frame.reset();
    bake.resolution.reset();
    constexpr double hair = 1 + 1e-6;
    bake.voxel_size_m = float(longest_m(cover_) * hair / layers);
    if (candidates_.size() > 1) bake.levels = levels_for(layers, bake.estimator);
    bake.lattice = default_lattice(*lit_.scene, bake);
    return bake;
  }

  double pilot_seconds(double layers) const {
    const Lattice lattice = *pilot_params(layers).lattice;
    if (grid_memory_bytes(lattice, params_.bake, 1) > memory_limit_bytes(params_.bake))
      return std::numeric_limits<double>::infinity();
    return 2 * costs_.seconds(double(lattice.vertex_count()), layers_of(lattice.finest_frame()),
                              pilot_photons(lattice) / 2);
  }

  void pilot(double layers) {
    const GridBakeParams bake = pilot_params(layers);
    const double photons = pilot_photons(*bake.lattice);
    PilotErrors errors = pilot(bake, photons);
    // The first one's photons are a guess.
    constexpr double too_much = 1.5;
    constexpr double most_times = 32;
    if (const double noise = std::max(errors.bias, aim_of_target * params_.target);
        pilots_.empty() && errors.noise > too_much * noise) {
      errors = pilot(bake, photons * std::min(most_times, std::pow(errors.noise / noise, 2)));
    }
    pilots_.push_back(errors);
  }

  // Two halves of its photons tell the grid's bias, (a - E)(b - E), and the noise of both together, (a - b)^2 / 4,
  // without a model of either.
  PilotErrors pilot(GridBakeParams bake, double photons_wanted) {
    const Lattice& lattice = *bake.lattice;
    const GridFrame& frame = lattice.finest_frame();
    const auto photons = std::uint64_t(photons_wanted) / 2 * 2;
    guide_photons_ = photons;
    bake.pilot_for_photons = photons;
    const auto start = Clock::now();
    bake.photons = photons;
    bake.photon_range = {{0, photons / 2}};
    GridAccumulator first = bake_grid_sums(lit_, bake);
    bake.photon_range = {{photons / 2, photons}};
    GridAccumulator second = bake_grid_sums(lit_, bake);
    measured_seconds_ += seconds_since(start);
    modelled_seconds_ += 2 * costs_.seconds(double(lattice.vertex_count()), layers_of(frame), double(photons) / 2);
    const IrradianceGrid a = resolve(first);
    const IrradianceGrid b = resolve(second);
    std::vector<std::array<double, 3>> squares(points_.size());
    tbb::parallel_for(std::size_t(0), points_.size(), [&](std::size_t i) {
      const TruePoint& point = points_[i];
      const V3d ea = read_grid(a, lit_.intersector, point.at, params_.lookup).e;
      const V3d eb = read_grid(b, lit_.intersector, point.at, params_.lookup).e;
      squares[i] = {(ea - point.truth.e).dot(eb - point.truth.e) / 3 - mean_of(point.truth.variance),
                    (ea - eb).length2() / 12, point.at.weight};
    });
    double bias = 0;
    double noise = 0;
    double weights = 0;
    for (const auto& [bias_square, noise_square, weight] : squares) {
      bias += weight * bias_square;
      noise += weight * noise_square;
      weights += weight;
    }
    constexpr double least_bias = 0.001;  // less is not told from nothing
    const PilotErrors errors{spacing_of(frame), double(photons),
                             std::max(least_bias, std::sqrt(std::max(0.0, bias / weights)) / mean_e_),
                             std::sqrt(noise / weights) / mean_e_};
    note(fmt::format("pilot of {}x{}x{} vertices, {} photons: bias {:.2g} %, noise {:.2g} %", frame.size.x,
                     frame.size.y, frame.size.z, photons, 100 * errors.bias, 100 * errors.noise));
    double stored = 0;
    for (const float fraction : first.visible_fraction) stored += fraction > 0 ? 1 : 0;
    stored_share_ = stored / double(lattice.vertex_count());
    photons_range_ = {0, photons};
    sums_ = merged(std::move(first), std::move(second));
    return errors;
  }

  void measure_direction() {
    if (params_.bake.include_direct) return;
    std::vector<MeasuredPoint> points;
    for (const TruePoint& point : points_) points.push_back({point, {}, {}});
    const DirectionErrors errors =
        direction_errors(lit_, points, pilot_params(2 * coarsest_layers).lattice->finest_frame(), mean_e_, truth_);
    direction_sh9_ = errors.sh9;
    if (params_.bake.basis == Basis::vectors) direction_ = errors.vectors;
    if (params_.bake.basis == Basis::vectors9) direction_ = errors.vectors9;
    if (params_.bake.basis == Basis::sh9) direction_ = errors.sh9;
  }

  double clock_scale() const { return modelled_seconds_ > 0 ? measured_seconds_ / modelled_seconds_ : 1; }

  PlanLimits limits() const {
    PlanLimits limits;
    limits.aim = aim_of_target * params_.target;
    if (params_.bake.photons != 0) limits.photons = double(params_.bake.photons);
    if (params_.most_work) {
      GridBakeParams usual = params_.bake;
      usual.resolution.reset();
      usual.voxel_size_m = float(longest_m(cover_) / usual_layers);
      const double vertices = double(default_frame(*lit_.scene, usual).vertex_count());
      limits.most_seconds =
          *params_.most_work *
          costs_.seconds(vertices, usual_layers, std::max(least_usual_photons, usual_photons_a_vertex * vertices));
    }
    if (params_.most_seconds) {
      const double left = *params_.most_seconds - seconds_since(start_) - certificate_paths_ * path_seconds_;
      limits.most_seconds = std::min(limits.most_seconds.value_or(std::numeric_limits<double>::infinity()),
                                     std::max(0.0, left) / clock_scale());
    }
    return limits;
  }

  bool at_hand_is(const Lattice& lattice) const { return static_cast<const Lattice&>(*sums_) == lattice; }

  void choose() {
    std::vector<Spacing> spacings;
    for (const Candidate& c : candidates_) {
      const bool at_hand = sums_ && at_hand_is(c.lattice);
      spacings.push_back({spacing_of(c.finest()), double(c.lattice.vertex_count()), layers_of(c.finest()),
                          at_hand ? double(photons_range_.second) : 0});
    }
    model_ = fit_errors(pilots_, direction_);
    chosen_ = choose_plan(spacings, model_, costs_, limits());
  }

  GridPlan describe() const {
    GridPlan plan;
    const Lattice& lattice = candidates_[chosen_.spacing].lattice;
    plan.frame = lattice.finest_frame();
    plan.levels = lattice.levels();
    plan.vertices = lattice.vertex_count();
    plan.photons = chosen_.photons;
    // RMS differences between spacings guess the error to within 0.77 to 1.5; points with their truth do better.
    plan.error = {0.8 * chosen_.error, chosen_.error, 1.25 * chosen_.error};
    plan.bias = chosen_.bias;
    plan.noise = chosen_.noise;
    plan.direction = model_.direction;
    plan.direction_sh9 = direction_sh9_;
    const double bake_seconds = chosen_.seconds * clock_scale();
    const double seconds = bake_seconds + certificate_paths_ * path_seconds_;
    plan.seconds = {0.6 * seconds, seconds, 1.8 * seconds};
    const int threads = params_.bake.threads > 0 ? params_.bake.threads : tbb::this_task_arena::max_concurrency();
    const double one = grid_memory_bytes(lattice, params_.bake, 1);
    const double all = grid_memory_bytes(lattice, params_.bake, threads);
    plan.memory_bytes = {one, std::min(all, memory_limit_bytes(params_.bake)), all};
    const double a_vertex = 12.0 * function_count(params_.bake.basis) + 4 + 12 + 16;
    const double file = a_vertex * stored_share_ * double(plan.vertices);
    plan.file_bytes = {0.6 * file, 0.9 * file, 1.2 * file};
    plan.meets = chosen_.meets;
    if (!plan.meets) plan.limited_by = what_limits();
    plan.pilots = pilots_;
    return plan;
  }

  std::string what_limits() const {
    if (model_.direction > aim_of_target * params_.target)
      return fmt::format("the directional basis, which alone is {:.2g} % off", 100 * model_.direction);
    if (candidates_.size() == 1) return "the spacing, which is given";
    if (params_.bake.photons != 0) return "the photons, whose number is given";
    if (params_.most_seconds) return "the time that is given";
    if (params_.most_work) return "the work of a bake that no error was asked for";
    return limited_by_;
  }

  // The bake that would be made without any of this.
  GridPlan unknown_plan() const {
    GridPlan plan;
    const Lattice usual = default_lattice(*lit_.scene, params_.bake);
    plan.frame = usual.finest_frame();
    plan.vertices = usual.vertex_count();
    plan.photons = params_.bake.photons != 0
                       ? params_.bake.photons
                       : std::uint64_t(std::max(least_usual_photons, usual_photons_a_vertex * double(plan.vertices)));
    plan.limited_by = "light: it reaches too little of the domain to plan by";
    return plan;
  }

  void bake_chosen() {
    const Lattice& lattice = candidates_[chosen_.spacing].lattice;
    GridBakeParams bake = candidates_[chosen_.spacing].bake;
    bake.lattice = lattice;
    bake.photons = chosen_.photons;
    const auto start = Clock::now();
    // Where photons are sent was found out for so many of them; for many more it is worth another look.
    constexpr double stale = 8;
    const bool goes_on =
        sums_ && at_hand_is(lattice) && photons_range_.second <= chosen_.photons &&
        (bake.emission != EmissionMode::guided || double(chosen_.photons) <= stale * double(guide_photons_));
    note(fmt::format("{} {} vertices on {} level{}, {:.4g} m apart{}, to {} photons",
                     goes_on ? "going on with" : "baking", lattice.vertex_count(), lattice.levels(),
                     lattice.levels() == 1 ? "" : "s", spacing_of(lattice.finest_frame()),
                     lattice.levels() == 1 ? "" : " on the finest", chosen_.photons));
    if (!goes_on) {
      sums_.reset();
      guide_photons_ = chosen_.photons;
      sums_ = bake_grid_sums(lit_, bake);
    } else if (photons_range_.second < chosen_.photons) {
      bake.pilot_for_photons = guide_photons_;
      bake.photon_range = {{photons_range_.second, chosen_.photons}};
      GridAccumulator more = bake_grid_sums(lit_, bake);
      sums_->metadata["photons"] = more.metadata["photons"];
      sums_ = merged(std::move(*sums_), std::move(more));
    }
    measured_seconds_ += seconds_since(start);
    modelled_seconds_ += chosen_.seconds;
    bake_seconds_ += chosen_.seconds;
    photons_range_ = {0, chosen_.photons};
  }

  std::optional<FieldCertificate> certificate(int round) const {
    CertificateParams measure;
    measure.target = params_.target;
    measure.lookup = params_.lookup;
    measure.truth = truth_;
    measure.first_point = std::uint64_t(round - 1) * points_a_round;
    // Half of the bake's own work at most, or some seconds.
    constexpr double least_paths = 1'000'000;
    constexpr double path_s = 2e-6;  // of the cost model's machine
    measure.most_paths = std::uint64_t(std::clamp(bake_seconds_ / 2 / path_s, least_paths, double(measure.most_paths)));
    return certify(lit_, resolve(*sums_), domain_, measure);
  }

  struct Reached {
    double error = 0;  // shares of mean E
    double noise = 0;
  };

  Reached error_at_planning_points() const {
    const IrradianceGrid grid = resolve(*sums_);
    std::vector<ErrorSample> samples(points_.size());
    std::vector<double> noise(points_.size());
    tbb::parallel_for(std::size_t(0), points_.size(), [&](std::size_t i) {
      const Reading reading = read_grid(grid, lit_.intersector, points_[i].at, params_.lookup);
      samples[i] = error_sample(points_[i], reading.e);
      noise[i] = mean_of(reading.noise);
    });
    double squares = 0;
    double weights = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      squares += points_[i].at.weight * noise[i];
      weights += points_[i].at.weight;
    }
    return {root_mean_square(samples).error, std::sqrt(squares / weights) / mean_e_};
  }

  // What was measured takes the place of what was predicted. False where it is no more than the target, and where
  // nothing within bounds promises less.
  bool improve(const Reached& reached) {
    const double error = reached.error;
    if (error <= params_.target) return false;
    const double noise = std::min(reached.noise, 0.95 * error);
    const PilotErrors here{spacing_of(sums_->finest_frame()), double(photons_range_.second),
                           std::sqrt(std::max(error * error - noise * noise, 1e-8)), noise};
    std::erase_if(pilots_, [&](const PilotErrors& p) { return p.spacing_m <= here.spacing_m * 1.05; });
    pilots_.push_back(here);
    const Plan before = chosen_;
    choose();
    if (chosen_.spacing == before.spacing && chosen_.photons <= before.photons) return false;
    constexpr double worth = 0.95;
    if (!chosen_.meets && !(chosen_.error < worth * error)) return false;
    note(fmt::format("error {:.2g} % is above {:.2g} %: going on", 100 * error, 100 * params_.target));
    return true;
  }

  const LitScene& lit_;
  const ContractParams& params_;
  GridFrame cover_;
  Domain domain_;
  TruthParams truth_;
  CostModel costs_;
  Clock::time_point start_ = Clock::now();

  std::vector<TruePoint> points_;
  double mean_e_ = 0;
  double path_seconds_ = 0;
  double certificate_paths_ = 0;
  double direction_ = 0;
  std::optional<double> direction_sh9_;

  std::vector<Candidate> candidates_;
  std::string limited_by_;
  std::vector<PilotErrors> pilots_;
  double measured_seconds_ = 0;
  double modelled_seconds_ = 0;
  double bake_seconds_ = 0;  // modelled, the pilots' not counted
  double stored_share_ = 1;
  ErrorModel model_;
  Plan chosen_;

  std::optional<GridAccumulator> sums_;  // of the last pilot, then of the bake
  std::pair<std::uint64_t, std::uint64_t> photons_range_{0, 0};
  std::uint64_t guide_photons_ = 0;  // that the emission of `sums_` was guided for
};

int thread_limit(const ContractParams& params) {
  return params.bake.threads > 0 ? params.bake.threads : tbb::this_task_arena::max_concurrency();
}

}  // namespace

GridPlan plan_grid(const LitScene& lit, const ContractParams& params) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(thread_limit(params)));
  return Planner(lit, params).plan();
}

ContractResult bake_to_error(const LitScene& lit, const ContractParams& params) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(thread_limit(params)));
  return Planner(lit, params).bake();
}

}  // namespace ivory
