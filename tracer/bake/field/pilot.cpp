#include "tracer/bake/field/pilot.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "tracer/bake/field/deposit/target.h"
#include "tracer/render/photons/tracer.h"

// What is sought is E in every cell c of the grid, with an error small beside E there, but not beside next to nothing:
//
//   sum over c of w_c Var(E_c),   w_c = 1 / (E_c^2 + (dim E)^2),
//
// with E the mean over cells that light reaches. A photon adds d_c, power times length over the cell's volume, to the
// E of the cells that it passes, so its share of the sum's second moment is sum w_c d_c^2: the square that the guide
// goes by (tracer/lights/guide.cpp). The same weights say what a photon should carry in a cell. P being its power, the
// cell's variance goes as P E_c and the time spent in it as E_c / P; the sum of w_c P_c E_c at a given sum of E_c / P_c
// is least for
//
//   P_c ~ 1 / sqrt(w_c) = sqrt(E_c^2 + (dim E)^2),
//
// where dim may be less: splitting photons in the dark costs nothing elsewhere, and hangs on no single photon. Above
// the mean P_c stays what most photons carry: there the error counts beside the mean as well.

namespace ivory {

namespace {

constexpr std::uint64_t fewest_photons = 1024;
constexpr std::uint64_t most_photons = 131'072;
constexpr std::uint64_t bake_a_pilot = 32;
constexpr std::uint64_t photons_a_batch = 256;
constexpr int longest_side = 16;  // cells
constexpr double defensive = 0.125;
constexpr double dim = 0.1;
constexpr double dim_of_window = 0.02;
constexpr double least_power = 1.0 / 32;  // of what most photons carry

constexpr int enough_steps = 32;  // in a cell, to know its E to a fifth

// A step of a photon's way inside a cell.
struct Visit {
  std::uint32_t photon;  // of its round
  std::uint32_t cell;
  float power_lm;  // strongest channel
  float per_m2;    // length over the cell's volume
};

struct Round {
  Lights::Emission emission;
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  std::vector<Visit> visits;  // photon by photon
};

GridFrame coarse_frame(const GridFrame& fine) {
  GridFrame frame = fine;
  const V3f extent = V3f(fine.size) * fine.spacing_m;
  const float longest = std::max({extent.x, extent.y, extent.z});
  for (unsigned axis = 0; axis < 3; ++axis) {
    const int wanted = int(std::ceil(extent[axis] / longest * longest_side - 1e-3F));
    frame.size[axis] = std::clamp(wanted, 2, std::max(2, fine.size[axis]));
  }
  frame.spacing_m = extent / V3f(frame.size);
  frame.origin_m = fine.to_world(V3f(-0.5F, -0.5F, -0.5F)) + frame.direction_to_world(frame.spacing_m * 0.5F);
  return frame;
}

class Scout {
 public:
  Scout(const LitScene& lit, const GridFrame& frame, const PilotParams& params, std::uint64_t total)
      : lit_(lit), frame_(frame), params_(params), total_(total) {
    volume_m3_ = double(frame.spacing_m.x) * double(frame.spacing_m.y) * double(frame.spacing_m.z);
  }

  Round run(const Lights::Emission& emission, const PhotonAim& aim, std::uint64_t begin, std::uint64_t end) {
    const PhotonTracer tracer(lit_, {.max_bounces = params_.max_bounces,
                                     .include_direct = params_.include_direct,
                                     .seed = params_.seed,
                                     .emission = emission,
                                     .aim = aim,
                                     .purpose = StreamPurpose::pilot});
    const std::uint64_t batches = (end - begin + photons_a_batch - 1) / photons_a_batch;
    std::vector<std::vector<Visit>> found(batches);
    tbb::parallel_for(std::uint64_t(0), batches, [&](std::uint64_t batch) {
      std::vector<PhotonSegment> segments;
      PhotonLedger ledger;
      const std::uint64_t first = begin + batch * photons_a_batch;
      const std::uint64_t last = std::min(first + photons_a_batch, end);
      for (std::uint64_t photon = first; photon < last; ++photon) {
        segments.clear();
        tracer.trace(photon, photon + 1, segments, ledger);
        for (const PhotonSegment& segment : segments) visit(segment, std::uint32_t(photon - begin), found[batch]);
      }
      if (params_.progress) {
        const std::lock_guard lock(mutex_);
        done_ += last - first;
        params_.progress(done_, total_);
      }
    });
    Round round{emission, begin, end, {}};
    for (const std::vector<Visit>& visits : found)
      round.visits.insert(round.visits.end(), visits.begin(), visits.end());
    return round;
  }

 private:
  // One jittered position per slice of the segment's dominant axis, as photon_deposit.cpp does it.
  void visit(const PhotonSegment& segment, std::uint32_t photon, std::vector<Visit>& visits) const {
    const std::optional<IndexSegment> inside = clip(frame_, segment);
    if (!inside) return;
    const V3f& d = inside->per_metre;
    const float step_m = 1 / std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    const float power = max_component(segment.power_lm);
    for (float t = segment.jitter * step_m; t < inside->length_m; t += step_m) {
      const V3f p = inside->start + d * t;
      V3i cell;
      for (unsigned axis = 0; axis < 3; ++axis) cell[axis] = std::clamp(int(p[axis]), 0, frame_.size[axis] - 1);
      visits.push_back({photon, std::uint32_t(frame_.vertex_index(cell.x, cell.y, cell.z)), power,
                        float(double(step_m) / volume_m3_)});
    }
  }

  const LitScene& lit_;
  const GridFrame& frame_;
  const PilotParams& params_;
  std::uint64_t total_;
  double volume_m3_ = 0;
  std::mutex mutex_;
  std::uint64_t done_ = 0;
};

// E in each cell, with its neighbours where few photons came to it, for the strongest channel and a receiver that faces
// the light: lux.
std::vector<double> mean_e(const GridFrame& frame, const std::vector<Round>& rounds) {
  std::vector<double> sums(frame.vertex_count(), 0);
  std::vector<int> steps(frame.vertex_count(), 0);
  double photons = 0;
  for (const Round& round : rounds) {
    for (const Visit& v : round.visits) {
      sums[v.cell] += double(v.power_lm) * double(v.per_m2);
      ++steps[v.cell];
    }
    photons += double(round.end - round.begin);
  }
  std::vector<double> means(sums.size(), 0);
  for (std::size_t v = 0; v < sums.size(); ++v) {
    if (steps[v] >= enough_steps) {
      means[v] = sums[v] / photons;
      continue;
    }
    const V3i at = frame.vertex_coordinates(v);
    double total = 0;
    int cells = 0;
    for (int z = std::max(0, at.z - 1); z <= std::min(frame.size.z - 1, at.z + 1); ++z) {
      for (int y = std::max(0, at.y - 1); y <= std::min(frame.size.y - 1, at.y + 1); ++y) {
        for (int x = std::max(0, at.x - 1); x <= std::min(frame.size.x - 1, at.x + 1); ++x) {
          const double sum = sums[frame.vertex_index(x, y, z)];
          total += sum;
          cells += sum > 0 ? 1 : 0;
        }
      }
    }
    means[v] = cells > 0 ? total / cells / photons : 0;
  }
  return means;
}

// sqrt(E_c^2 + (dim E)^2) of each cell, for the guide and for the window, and E, the mean over cells that light
// reaches; 0 where it reaches none.
struct Levels {
  std::vector<double> cell;
  std::vector<double> window;
  double mean = 0;
};
Levels levels(const GridFrame& frame, const std::vector<Round>& rounds) {
  Levels out{mean_e(frame, rounds), {}, 0};
  double lit = 0;
  for (const double e : out.cell) {
    out.mean += e;
    lit += e > 0 ? 1 : 0;
  }
  if (lit == 0) return out;
  out.mean /= lit;
  for (const double e : out.cell) out.window.push_back(std::hypot(e, dim_of_window * out.mean));
  for (double& e : out.cell) e = std::hypot(e, dim * out.mean);
  return out;
}

PhotonWindow make_window(const GridFrame& frame, const Levels& levels, double typical_lm) {
  PhotonWindow window{frame, std::vector<float>(frame.vertex_count())};
  for (std::size_t c = 0; c < window.power_lm.size(); ++c)
    window.power_lm[c] = float(typical_lm * std::clamp(levels.window[c] / levels.mean, least_power, 1.0));
  return window;
}

// What photons that bring light to the grid set out with: the median, by what they bring. 0: none does. (Not what they
// carry in the grid: that depends on how they were split, and splitting on this.)
double typical_power(const LitScene& lit, const PilotParams& params, const Round& round) {
  struct Brought {
    float power_lm;
    double lux;
  };
  std::vector<Brought> photons;
  double total = 0;
  for (std::size_t i = 0; i < round.visits.size();) {
    const std::uint32_t photon = round.visits[i].photon;
    RandomStream random(params.seed, StreamPurpose::pilot, round.begin + photon);
    Brought brought{max_component(lit.lights.emit(round.emission, random).power), 0};
    for (; i < round.visits.size() && round.visits[i].photon == photon; ++i)
      brought.lux += double(round.visits[i].power_lm) * double(round.visits[i].per_m2);
    total += brought.lux;
    photons.push_back(brought);
  }
  std::ranges::sort(photons, {}, &Brought::power_lm);
  double sum = 0;
  for (const Brought& photon : photons) {
    sum += photon.lux;
    if (sum >= 0.5 * total) return double(photon.power_lm);
  }
  return 0;
}

double reach(const Round& round) {
  double met = 0;
  for (std::size_t i = 0; i < round.visits.size(); ++i)
    met += i == 0 || round.visits[i].photon != round.visits[i - 1].photon ? 1 : 0;
  return met / double(round.end - round.begin);
}

// What each photon of the rounds would bring where nothing is guided. Where the window will split it, its pieces bring
// a part of its square each: as if its power were the geometric mean of its own and the window's.
void add_samples(const Round& round, const PilotParams& params, const Levels& levels, const PhotonWindow* window,
                 std::vector<GuideSample>& samples) {
  std::size_t next = 0;
  for (std::uint64_t photon = round.begin; photon < round.end; ++photon) {
    GuideSample sample;
    RandomStream random(params.seed, StreamPurpose::pilot, photon);
    sample.point = round.emission.guide().sample(random);
    for (; next < round.visits.size() && round.visits[next].photon == photon - round.begin; ++next) {
      const Visit& v = round.visits[next];
      const double relative = double(v.power_lm) * double(v.per_m2) / levels.cell[v.cell];
      const double pieces = window ? std::max(1.0, double(v.power_lm) / double(window->power_lm[v.cell])) : 1;
      sample.square += relative * relative / pieces;
    }
    sample.square *= sample.point.density * sample.point.density;
    samples.push_back(sample);
  }
}

}  // namespace

Pilot run_pilot(const LitScene& lit, const GridFrame& frame, const Lights::Emission& emission,
                const PilotParams& params) {
  Pilot pilot{emission, nullptr, std::nullopt};
  const std::uint64_t photons = std::min(params.photons / bake_a_pilot, most_photons);
  if (photons < fewest_photons) return pilot;
  const GridFrame coarse = coarse_frame(frame);
  Scout scout(lit, coarse, params, photons);

  PhotonAim aim{coarse};

  // Without a guide; by a first guide, which finds the edges of what matters; and by the last, for what its photons
  // carry.
  std::vector<Round> rounds;
  std::vector<GuideSample> samples;
  Levels found;
  const auto guide = [&](const PhotonWindow* window) {
    samples.clear();
    for (const Round& round : rounds) add_samples(round, params, found, window, samples);
    const Lights::Emission& last = rounds.back().emission;
    return last.guided(make_guide(last.strata(), samples, defensive), 0);
  };
  rounds.push_back(scout.run(lit.lights.guidable(emission), aim, 0, photons / 4));
  pilot.photons = photons / 4;
  pilot.reach_before = pilot.reach_after = reach(rounds[0]);
  if (rounds[0].visits.empty()) return pilot;
  found = levels(coarse, rounds);
  aim.sought_lm = float(typical_power(lit, params, rounds[0]));

  rounds.push_back(scout.run(guide(nullptr), aim, photons / 4, 3 * photons / 4));
  found = levels(coarse, rounds);
  double typical_lm = typical_power(lit, params, rounds[1]);
  aim.sought_lm = float(typical_lm);
  const PhotonWindow first = make_window(coarse, found, typical_lm);

  const Lights::Emission guided = guide(typical_lm > 0 ? &first : nullptr);
  rounds.push_back(scout.run(guided, aim, 3 * photons / 4, photons));
  pilot.photons = photons;
  pilot.reach_after = reach(rounds[2]);
  found = levels(coarse, rounds);
  typical_lm = typical_power(lit, params, rounds[2]);
  pilot.emission = guided.guided(guided.guide(), float(typical_lm));
  aim.sought_lm = float(typical_lm);
  pilot.aim = aim;
  if (typical_lm > 0) pilot.window = std::make_shared<const PhotonWindow>(make_window(coarse, found, typical_lm));
  return pilot;
}

}  // namespace ivory
