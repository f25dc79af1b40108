#include "tools/bench/measure_tracer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "grid/field/resolve.h"
#include "tools/bench/clock.h"
#include "tools/bench/median.h"
#include "tracer/bake/field/baker.h"
#include "tracer/bake/field/deposit/photon_deposit.h"
#include "tracer/bake/field/vertex_visibility.h"
#include "tracer/render/photons/tracer.h"

namespace ivory {
namespace {

constexpr std::uint64_t batch = 2048;

struct Worker {
  std::optional<PhotonDepositor> depositor;
  std::vector<PhotonSegment> segments;
  PhotonLedger ledger;
};

// Traces [begin, end) on `threads` threads and deposits into `target` unless that is null. The number of rays goes to
// `rays`.
BenchTime trace_and_deposit(const PhotonTracer& tracer, std::uint64_t begin, std::uint64_t end, DepositTarget* target,
                            TrackWalk walk, int threads, std::int64_t& rays) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
  tbb::enumerable_thread_specific<Worker> workers([&] {
    Worker worker;
    if (target != nullptr) worker.depositor.emplace(*target, walk);
    return worker;
  });
  // Buffers are made before the clock starts: a bake makes them once for hours of work.
  tbb::parallel_for(0, 4 * threads, [&](int) { workers.local(); });
  const BenchTime time = time_of([&] {
    tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, (end - begin + batch - 1) / batch), [&](const auto& range) {
      Worker& worker = workers.local();
      for (std::uint64_t b = range.begin(); b < range.end(); ++b) {
        worker.segments.clear();
        tracer.trace(begin + b * batch, std::min(begin + (b + 1) * batch, end), worker.segments, worker.ledger);
        if (worker.depositor) worker.depositor->deposit(worker.segments);
      }
    });
    std::vector<PhotonDepositor*> depositors;
    for (Worker& worker : workers) {
      if (worker.depositor) depositors.push_back(&*worker.depositor);
    }
    tbb::parallel_for(std::size_t(0), depositors.size(), [&](std::size_t i) { depositors[i]->settle(); });
  });
  rays = 0;
  for (Worker& worker : workers) {
    if (worker.depositor) worker.depositor->flush();
    rays += worker.ledger.rays;
  }
  return time;
}

// The tracer's own rays, with the order they were traced in.
std::vector<Ray> record_rays(const LitScene& lit, const TracerBenchParams& params) {
  const PhotonTracer tracer(lit, {.include_direct = true, .seed = params.seed});
  std::vector<PhotonSegment> segments;
  PhotonLedger ledger;
  tracer.trace(0, params.photons, segments, ledger);
  std::vector<Ray> rays;
  rays.reserve(segments.size());
  for (const PhotonSegment& segment : segments)
    rays.push_back({.origin = segment.origin, .direction = segment.direction});
  return rays;
}

BenchTime replay(const Intersector& intersector, const std::vector<Ray>& rays, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
  return time_of([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rays.size(), 8192), [&](const auto& range) {
      intersector.count_hits(std::span<const Ray>(rays).subspan(range.begin(), range.size()));
    });
  });
}

// Mean over the vertices that hold light of the variance of F and D, divided by the mean of their
// squares, for one photon: measured over disjoint ranges of photons.
double relative_variance(const PhotonTracer& tracer, const DepositTarget& empty,
                         const std::vector<float>& visible_fraction, TrackWalk walk, const TracerBenchParams& params,
                         int threads) {
  constexpr int parts = 16;
  std::vector<double> sum;
  std::vector<double> squares;
  const std::uint64_t photons = std::max<std::uint64_t>(params.photons / parts, batch);
  for (int part = 0; part < parts; ++part) {
    DepositTarget target = empty;
    std::int64_t rays = 0;
    trace_and_deposit(tracer, std::uint64_t(part) * photons, std::uint64_t(part + 1) * photons, &target, walk, threads,
                      rays);
    GridAccumulator sums = to_accumulator(target);
    sums.visible_fraction = visible_fraction;
    sums.photon_end = photons;
    const IrradianceGrid grid = resolve(sums);
    sum.resize(grid.moments.size());
    squares.resize(grid.moments.size());
    for (std::size_t i = 0; i < grid.moments.size(); ++i) {
      sum[i] += double(grid.moments[i]);
      squares[i] += double(grid.moments[i]) * double(grid.moments[i]);
    }
  }
  double variance = 0;
  double power = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double mean = sum[i] / parts;
    variance += (squares[i] / parts - mean * mean) * parts / (parts - 1);
    power += mean * mean;
  }
  return power > 0 ? variance / power * double(photons) : 0;
}

}  // namespace

TracerBench bench_tracer(const LitScene& lit, const TracerBenchParams& params) {
  const Scene& scene = *lit.scene;
  const int threads = params.threads > 0 ? params.threads : tbb::this_task_arena::max_concurrency();
  const PhotonTracer tracer(lit, {.seed = params.seed});
  GridBakeParams placement;
  placement.resolution = params.resolution;
  const GridFrame frame = default_frame(scene, placement);
  const std::vector<std::uint64_t> masks = vertex_cell_masks(lit.intersector, frame);
  const Lights::PhotonPower power = lit.lights.photon_power();
  const std::vector<Ray> rays = record_rays(lit, params);

  TracerBench bench;
  for (const Instance& instance : scene.instances)
    bench.triangles += scene.meshes[std::size_t(instance.mesh)].triangles.size();

  struct Method {
    const char* name;
    Estimator estimator;
    TrackWalk walk;
  };
  const std::vector<Method> methods{{"track, sampled", Estimator::track, TrackWalk::sampled},
                                    {"track, exact", Estimator::track, TrackWalk::exact},
                                    {"face", Estimator::face, TrackWalk::sampled}};
  std::vector<DepositTarget> targets;
  targets.reserve(methods.size());
  for (const Method& method : methods) {
    targets.push_back(
        make_deposit_target(frame, Basis::vectors, method.estimator, power.strongest_lm, masks, fine_bits(power)));
  }

  std::vector<double> bake_rate;
  std::vector<double> embree_rate;
  std::vector<double> ratio;
  std::vector<double> bare_ratio;
  std::vector<double> bare_time;
  std::vector<double> speed_up;
  std::vector<std::vector<double>> method_time(methods.size());
  std::int64_t traced = 0;
  for (int round = 0; round < params.rounds; ++round) {
    const double embree_s = replay(lit.intersector, rays, threads).cpu_s / threads;
    for (std::size_t m = 0; m < methods.size(); ++m) {
      method_time[m].push_back(
          trace_and_deposit(tracer, 0, params.photons, &targets[m], methods[m].walk, threads, traced).cpu_s / threads);
    }
    bare_time.push_back(
        trace_and_deposit(tracer, 0, params.photons, nullptr, TrackWalk::sampled, threads, traced).cpu_s / threads);
    bake_rate.push_back(double(traced) / method_time[0].back());
    embree_rate.push_back(double(rays.size()) / embree_s);
    ratio.push_back(bake_rate.back() / embree_rate.back());
    bare_ratio.push_back(double(traced) / bare_time.back() / embree_rate.back());
    if (threads >= 2) {
      const BenchTime one = trace_and_deposit(tracer, 0, params.photons, &targets[0], TrackWalk::sampled, 1, traced);
      const BenchTime two = trace_and_deposit(tracer, 0, params.photons, &targets[0], TrackWalk::sampled, 2, traced);
      speed_up.push_back(one.wall_s / two.wall_s);
    }
  }
  bench.segments_per_s = median(bake_rate);
  bench.embree_rays_per_s = median(embree_rate);
  bench.embree_ratio = median(ratio);
  bench.undeposited_ratio = median(bare_ratio);
  if (!speed_up.empty()) bench.two_thread_speed_up = median(speed_up);

  const std::vector<float> visible_fraction = visible_fractions(masks);
  double exact_variance = 0;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::fill(targets[m].sums.begin(), targets[m].sums.end(), 0);
    DepositFigure figure;
    figure.name = methods[m].name;
    figure.segments_per_s = double(traced) / median(method_time[m]);
    figure.relative_variance =
        relative_variance(tracer, targets[m], visible_fraction, methods[m].walk, params, threads);
    if (methods[m].walk == TrackWalk::exact) exact_variance = figure.relative_variance;
    bench.deposits.push_back(figure);
  }
  for (std::size_t m = 0; m < methods.size(); ++m) {
    bench.deposits[m].variance_time =
        bench.deposits[m].relative_variance * median(method_time[m]) / (exact_variance * median(bare_time));
  }
  return bench;
}

PhotonBench::PhotonBench(const LitScene& lit, const TracerBenchParams& params)
    : lit_(lit), params_(params), tracer_(lit, {.seed = params.seed}), rays_(record_rays(lit, params)) {
  GridBakeParams placement;
  placement.resolution = params.resolution;
  const GridFrame frame = default_frame(*lit.scene, placement);
  const Lights::PhotonPower power = lit.lights.photon_power();
  target_ = make_deposit_target(frame, Basis::vectors, Estimator::track, power.strongest_lm,
                                vertex_cell_masks(lit.intersector, frame), fine_bits(power));
}

double PhotonBench::deposit_s() {
  std::int64_t rays = 0;
  return trace_and_deposit(tracer_, 0, params_.photons, &target_, TrackWalk::sampled, params_.threads, rays).cpu_s;
}

double PhotonBench::replay_s() const { return replay(lit_.intersector, rays_, params_.threads).cpu_s; }

Scene make_bench_scene(std::size_t triangles) {
  Scene scene;
  scene.name = "cave";
  Material material;
  material.base_color = Rgb(0.7F, 0.6F, 0.5F);
  material.metallic = 0;
  material.specular = 0;
  material.double_sided = true;
  scene.materials.push_back(material);

  // A longitude-latitude mesh, two triangles a quad.
  const auto rings = static_cast<int>(std::sqrt(double(triangles) / 4));
  const int sectors = 2 * rings;
  Mesh cave;
  cave.material = 0;
  for (int r = 0; r <= rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      const float theta = pi * static_cast<float>(r) / static_cast<float>(rings);
      const float phi = 2 * pi * static_cast<float>(s) / static_cast<float>(sectors);
      const float bumps = std::sin(12 * theta) * std::sin(14 * phi) + 0.3F * std::sin(57 * theta + 3 * phi);
      const float radius_m = 2 + 0.25F * bumps * std::sin(theta);
      cave.positions.emplace_back(radius_m * std::sin(theta) * std::cos(phi), radius_m * std::cos(theta),
                                  radius_m * std::sin(theta) * std::sin(phi));
    }
  }
  const auto index = [&](int r, int s) { return static_cast<std::uint32_t>(r * sectors + s % sectors); };
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      cave.triangles.emplace_back(index(r, s), index(r + 1, s), index(r, s + 1));
      cave.triangles.emplace_back(index(r, s + 1), index(r + 1, s), index(r + 1, s + 1));
    }
  }
  scene.instances.push_back({0, M44f()});
  scene.meshes.push_back(std::move(cave));
  scene.lights.emplace_back(PointLight{V3f(0.6F, 0.7F, 0.5F), Rgb(100, 100, 100)});
  return scene;
}

}  // namespace ivory
