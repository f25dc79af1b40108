// How near the photon tracer comes to the rate of its rays alone, and what each way to deposit is worth.
#pragma once

#include <string>
#include <vector>

#include "tracer/bake/field/deposit/target.h"
#include "tracer/core/lit_scene.h"
#include "tracer/render/photons/tracer.h"

namespace ivory {

struct TracerBenchParams {
  V3i resolution{32, 32, 32};
  std::uint64_t photons = 400'000;  // a measurement
  int rounds = 5;                   // measurements are taken in turn this often; medians are reported
  int threads = 0;
  std::uint64_t seed = 1;
};

// One way to deposit. Figures of merit are variance times time, relative to a deposit that costs nothing
// and has the variance of exact lengths.
struct DepositFigure {
  std::string name;
  double segments_per_s = 0;
  double relative_variance = 0;  // of the stored moments, a photon traced
  double variance_time = 0;      // 1 would be the free deposit
};

struct TracerBench {
  std::size_t triangles = 0;
  // Rates are by the process's own time over its threads.
  double segments_per_s = 0;       // rays traced and deposited, the way bakes do it
  double embree_rays_per_s = 0;    // the same rays replayed through Embree's closest hit alone
  double embree_ratio = 0;         // the first over the second, median of side-by-side rounds
  double undeposited_ratio = 0;    // the same for photons traced and not deposited
  double two_thread_speed_up = 0;  // whole deposits, two threads over one by the clock; 0 on a single core
  std::vector<DepositFigure> deposits;
};

// What bakes do with photons, and Embree alone with their rays, to be measured in turn. `lit` must outlive it.
class PhotonBench {
 public:
  PhotonBench(const LitScene& lit, const TracerBenchParams& params);
  std::size_t rays() const { return rays_.size(); }
  // Seconds of the process's own time, all threads together.
  double deposit_s();
  double replay_s() const;

 private:
  const LitScene& lit_;
  TracerBenchParams params_;  // threads above 0
  PhotonTracer tracer_;
  std::vector<Ray> rays_;
  DepositTarget target_;
};

TracerBench bench_tracer(const LitScene& lit, const TracerBenchParams& params);

// A closed cave whose walls are one finely displaced mesh of about `triangles` triangles, with a point light
// in it: for measurements that need a large mesh and no file.
Scene make_bench_scene(std::size_t triangles);

}  // namespace ivory
