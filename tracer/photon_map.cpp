#include "tracer/photon_map.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <vector>

#include <nanoflann.hpp>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "grid/error.h"
#include "grid/memory.h"
#include "tracer/photon_tracer.h"

// Where photons of power Phi_i land on a surface like rain, E is their density: with r the distance to the K-th
// nearest of them, the K - 1 nearer ones give
//
//   E(x) = 1/(pi r^2) sum_{i<K} Phi_i,
//
// whose expectation is E where E is even over the disc (the K-th photon sits on the rim: counting it too would be
// too bright by 1/(K-1)). The photons are those in a ball around x; a ball cuts a disc of pi r^2 out of a plane and,
// exactly, out of a sphere through its centre.
//
// Christensen computes E at photons, every fourth is enough, and looks up the one nearest to x. A photon counts
// itself: that makes up for the hole around x, in which no such photon is known to lie. (A disc of points
// scattered at random with mean one holds no other point of that kind; one photon at its rim takes the place of the one
// that is missing. The hole has the area of four photons, so it fits into the disc for K of 20 and more; E is 6 % too
// bright at K = 10.)

namespace ivory {

namespace {

constexpr std::uint64_t photons_a_batch = 2048;
constexpr std::size_t photons_an_estimate = 4;  // Christensen's choice
constexpr float facing_alike = 0.7F;            // cosine between normals; walls at right angles are kept apart
// Estimates reach no farther, in radii of the scene: dark corners are not lit by photons of the other end.
constexpr float reach_radii = 0.1F;

struct Estimate {
  V3f p;
  V3f n;
  Rgb e;
};

// nanoflann's view of an array of structs with a place.
template <typename Point>
struct Cloud {
  std::vector<Point> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i].p[unsigned(axis)]; }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};

template <typename Point>
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud<Point>>, Cloud<Point>, 3,
                                                 std::uint32_t>;

// nanoflann's result set: the `capacity` nearest points that face as n does, as a heap with the farthest in front.
template <typename Point>
class NearestAlike {
 public:
  NearestAlike(const std::vector<Point>& points, const V3f& n, std::size_t capacity, float reach_squared)
      : points_(points), n_(n), capacity_(capacity), reach_squared_(reach_squared) {}

  bool addPoint(float distance_squared, std::uint32_t index) {
    if (points_[index].n.dot(n_) < facing_alike) return true;
    if (!(distance_squared < worstDist())) return true;
    if (full()) {
      std::pop_heap(heap_.begin(), heap_.end());
      heap_.pop_back();
    }
    heap_.emplace_back(distance_squared, index);
    std::push_heap(heap_.begin(), heap_.end());
    return true;
  }
  float worstDist() const { return full() ? heap_.front().first : reach_squared_; }
  bool full() const { return heap_.size() == capacity_; }
  std::size_t size() const { return heap_.size(); }
  const std::vector<std::pair<float, std::uint32_t>>& heap() const { return heap_; }

 private:
  const std::vector<Point>& points_;
  V3f n_;
  std::size_t capacity_;
  float reach_squared_;
  std::vector<std::pair<float, std::uint32_t>> heap_;
};

std::vector<PhotonArrival> trace(const Intersector& intersector, const Lights& lights, const PhotonMapParams& params) {
  const PhotonTracer tracer(intersector, lights, {.max_bounces = params.max_bounces, .seed = params.seed});
  const std::uint64_t batches = (params.photons + photons_a_batch - 1) / photons_a_batch;
  const auto trace_batch = [&](std::uint64_t batch) {
    std::vector<PhotonArrival> arrivals;
    PhotonLedger ledger;
    const std::uint64_t first = batch * photons_a_batch;
    tracer.trace_arrivals(first, std::min(first + photons_a_batch, params.photons), arrivals, ledger);
    arrivals.shrink_to_fit();
    return arrivals;
  };
  // The first batch tells how much room the others will take: twice while they are joined, and the trees.
  std::vector<PhotonArrival> first = trace_batch(0);
  check_memory(intersector.scene().name,
               double(batches) * (double(first.size()) * (2 * sizeof(PhotonArrival) + 16) + sizeof first),
               "ask for fewer --photons");
  std::vector<std::vector<PhotonArrival>> arrivals(batches);
  arrivals[0] = std::move(first);
  std::mutex mutex;
  std::uint64_t done = 1;
  tbb::parallel_for(std::uint64_t(1), batches, [&](std::uint64_t batch) {
    arrivals[batch] = trace_batch(batch);
    if (!params.progress) return;
    const std::lock_guard lock(mutex);
    params.progress(std::min(++done * photons_a_batch, params.photons), params.photons);
  });

  std::vector<PhotonArrival> joined;
  std::size_t count = 0;
  for (const auto& part : arrivals) count += part.size();
  if (count > std::numeric_limits<std::uint32_t>::max())
    throw UsageError("the photon map would hold more than 4 billion photons; ask for fewer --photons");
  joined.reserve(count);
  for (auto& part : arrivals) {
    joined.insert(joined.end(), part.begin(), part.end());
    std::vector<PhotonArrival>().swap(part);
  }
  return joined;
}

}  // namespace

struct PhotonMap::State {
  std::size_t photons_stored = 0;
  float reach_squared = 0;
  Cloud<Estimate> estimates;
  std::unique_ptr<Tree<Estimate>> tree;
};

PhotonMap::PhotonMap(const Intersector& intersector, const Lights& lights, const PhotonMapParams& params)
    : state_(std::make_unique<State>()) {
  if (lights.empty())
    throw Error(intersector.scene().name, "nothing in it shines", "add a light or an emissive material, or give --env");
  tbb::task_arena arena(params.threads > 0 ? params.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    State& state = *state_;
    Cloud<PhotonArrival> photons{trace(intersector, lights, params)};
    state.photons_stored = photons.points.size();
    const float reach = reach_radii * intersector.radius_m();
    state.reach_squared = reach * reach;
    const Tree<PhotonArrival> tree(3, photons);

    state.estimates.points.resize((photons.points.size() + photons_an_estimate - 1) / photons_an_estimate);
    const std::size_t neighbours = std::size_t(std::max(2, params.neighbours));
    // Where more than K photons came to one point, as in a focus, the disc has no area; rounding's has.
    const double least_squared = double(state.reach_squared) * 1e-10;
    std::mutex mutex;
    std::uint64_t done = 0;
    const auto estimate = [&](const tbb::blocked_range<std::size_t>& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const PhotonArrival& at = photons.points[i * photons_an_estimate];
        NearestAlike<PhotonArrival> nearest(photons.points, at.n, neighbours, state.reach_squared);
        tree.findNeighbors(nearest, &at.p.x, {});
        const auto& heap = nearest.heap();
        const double radius_squared = nearest.full() ? double(heap.front().first) : double(state.reach_squared);
        V3d sum(0, 0, 0);
        for (std::size_t k = nearest.full() ? 1 : 0; k < heap.size(); ++k)
          sum += V3d(photons.points[heap[k].second].power_lm);
        sum /= double(pi) * std::max(radius_squared, least_squared) * double(params.photons);
        state.estimates.points[i] = {at.p, at.n, Rgb(float(sum.x), float(sum.y), float(sum.z))};
      }
      if (!params.progress) return;
      const std::lock_guard lock(mutex);
      done += range.size();
      params.progress(done, state.estimates.points.size());
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, state.estimates.points.size(), 256), estimate);
    state.tree = std::make_unique<Tree<Estimate>>(3, state.estimates);
  });
}

PhotonMap::~PhotonMap() = default;
PhotonMap::PhotonMap(PhotonMap&&) noexcept = default;
PhotonMap& PhotonMap::operator=(PhotonMap&&) noexcept = default;

Rgb PhotonMap::irradiance(const V3f& p, const V3f& n) const {
  const State& state = *state_;
  struct NearestOne {
    const std::vector<Estimate>& points;
    const V3f& n;
    float best;
    std::int64_t index = -1;
    bool addPoint(float distance_squared, std::uint32_t i) {
      if (distance_squared < best && points[i].n.dot(n) >= facing_alike) {
        best = distance_squared;
        index = i;
      }
      return true;
    }
    float worstDist() const { return best; }
    bool full() const { return index >= 0; }
  } nearest{state.estimates.points, n, state.reach_squared};
  state.tree->findNeighbors(nearest, &p.x, {});
  return nearest.index < 0 ? Rgb(0, 0, 0) : state.estimates.points[std::size_t(nearest.index)].e;
}

std::size_t PhotonMap::photons_stored() const { return state_->photons_stored; }
std::size_t PhotonMap::estimates() const { return state_->estimates.points.size(); }
std::size_t PhotonMap::bytes() const {
  return state_->estimates.points.size() * sizeof(Estimate) + state_->tree->usedMemory(*state_->tree);
}

}  // namespace ivory
