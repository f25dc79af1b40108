#include "tracer/render/photons/map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

#include <nanoflann.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "tracer/render/photons/tracer.h"

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
// that is missing. The hole has the area of four photons on average. It fits into nearly all discs of 50 photons; at
// K = 20 it juts out of some, which makes E 1 % too bright, at K = 10 5 %.)

namespace ivory {

namespace {

constexpr std::uint64_t photons_a_batch = 2048;
constexpr std::size_t photons_an_estimate = 4;  // Christensen's choice
constexpr float facing_alike = 0.7F;            // cosine between normals; walls at right angles are kept apart
constexpr std::size_t photons_a_leaf = 16;      // of the tree, as many as are fastest for K = 50
// Estimates reach no farther, in radii of the scene: dark corners are not lit by photons of the other end.
constexpr float reach_radii = 0.1F;

// nanoflann's view of places.
struct Cloud {
  std::vector<V3f> places;
  std::size_t kdtree_get_point_count() const { return places.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return places[i][unsigned(axis)]; }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};

// Photons lie along a Morton curve, so that what an estimate reads lies together, and so do estimates that follow each
// other; in arrays of their own, as most photons that a search meets are told apart by their places alone.
struct Photons {
  Cloud cloud;
  std::vector<V3f> normals;
  std::vector<Rgb> powers_lm;
  std::vector<std::uint32_t> estimated;  // indices, ascending, of those at which E is computed
};

struct Estimates {
  Cloud cloud;
  std::vector<V3f> normals;
  std::vector<Rgb> e;
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, std::uint32_t>;

// nanoflann's result set: the `count` nearest points that face as n does. It takes in twice as many before it drops the
// farther half: a selection costs less than a heap that is in order after each of them.
class NearestAlike {
 public:
  NearestAlike(const std::vector<V3f>& normals, std::size_t count) : normals_(normals), count_(count) {
    found_.reserve(std::min(2 * count, normals.size()));
  }

  // Those nearer than the root of `bound`; if there are `count`, the farthest of them comes last.
  void search(const Tree& tree, const V3f& p, const V3f& n, float bound) {
    n_ = n;
    worst_ = bound;
    found_.clear();
    tree.findNeighbors(*this, &p.x, {});
    if (full()) drop_farther();
  }
  bool full() const { return found_.size() >= count_; }
  std::size_t size() const { return found_.size(); }
  std::uint32_t index(std::size_t k) const { return std::uint32_t(found_[k]); }
  float radius_squared() const { return worst_; }  // of the disc of `count` points, after a search that found them

  // What nanoflann calls.
  bool addPoint(float distance_squared, std::uint32_t index) {
    if (!(distance_squared < worst_) || normals_[index].dot(n_) < facing_alike) return true;
    found_.push_back(std::uint64_t(std::bit_cast<std::uint32_t>(distance_squared)) << 32 | index);
    if (found_.size() == 2 * count_) drop_farther();
    return true;
  }
  float worstDist() const { return worst_; }

 private:
  void drop_farther() {
    std::nth_element(found_.begin(), found_.begin() + std::ptrdiff_t(count_ - 1), found_.end());
    found_.resize(count_);
    worst_ = std::bit_cast<float>(std::uint32_t(found_.back() >> 32));
  }

  const std::vector<V3f>& normals_;
  std::size_t count_;
  V3f n_;
  float worst_ = 0;
  // Bits of the squared distance above the index: floats that are not negative are in the order of their bits.
  std::vector<std::uint64_t> found_;
};

std::vector<PhotonArrival> trace(const LitScene& lit, const PhotonMapParams& params) {
  const PhotonTracer tracer(lit, {.max_bounces = params.max_bounces, .seed = params.seed, .target = params.target});
  const std::uint64_t batches = (params.photons + photons_a_batch - 1) / photons_a_batch;
  const auto trace_batch = [&](std::uint64_t batch) {
    std::vector<PhotonArrival> arrivals;
    PhotonLedger ledger;
    const std::uint64_t first = batch * photons_a_batch;
    tracer.trace_arrivals(first, std::min(first + photons_a_batch, params.photons), arrivals, ledger);
    arrivals.shrink_to_fit();
    return arrivals;
  };
  // The first batch tells how much room the others will take: twice while they are joined, and again while they are put
  // in order, by keys of 16 bytes.
  std::vector<PhotonArrival> first = trace_batch(0);
  check_memory(
      lit.scene->name,
      double(batches) * (double(first.size()) * (2 * sizeof(PhotonArrival) + 16) + sizeof(std::vector<PhotonArrival>)),
      "ask for fewer photons");
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
    throw ParameterError("photons", "the photon map would hold more than 4 billion photons; ask for fewer");
  joined.reserve(count);
  for (auto& part : arrivals) {
    joined.insert(joined.end(), part.begin(), part.end());
    std::vector<PhotonArrival>().swap(part);
  }
  return joined;
}

// Every third bit of a number, from the lowest 21 of x.
std::uint64_t spread_by_three(std::uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

// Which photons are estimated at is settled before they are put in order: every fourth as they were traced is a choice
// by chance, which the hole around an estimate reckons with; every fourth along the curve would lie more evenly.
Photons put_in_order(const std::vector<PhotonArrival>& arrivals, const V3f& center, float radius_m) {
  using Key = std::pair<std::uint64_t, std::uint32_t>;  // place along the curve, index
  std::vector<Key> keys(arrivals.size());
  const V3f low = center - V3f(radius_m, radius_m, radius_m);
  constexpr float cells = 1 << 21;
  const tbb::blocked_range<std::size_t> all(0, arrivals.size(), 4096);
  tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const V3f cell = (arrivals[i].p - low) * (cells / (2 * radius_m));
      std::uint64_t code = 0;
      for (unsigned axis = 0; axis < 3; ++axis)
        code |= spread_by_three(std::uint64_t(std::clamp(cell[axis], 0.0F, cells - 1))) << axis;
      keys[i] = {code, std::uint32_t(i)};
    }
  });
  tbb::parallel_sort(keys.begin(), keys.end());

  Photons photons{{std::vector<V3f>(keys.size())}, std::vector<V3f>(keys.size()), std::vector<Rgb>(keys.size()), {}};
  tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const PhotonArrival& arrival = arrivals[keys[i].second];
      photons.cloud.places[i] = arrival.p;
      photons.normals[i] = arrival.n;
      photons.powers_lm[i] = arrival.power_lm;
    }
  });
  photons.estimated.reserve((keys.size() + photons_an_estimate - 1) / photons_an_estimate);
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (keys[i].second % photons_an_estimate == 0) photons.estimated.push_back(std::uint32_t(i));
  return photons;
}

Estimates places_of_estimates(const Photons& photons) {
  const std::size_t count = photons.estimated.size();
  Estimates estimates{{std::vector<V3f>(count)}, std::vector<V3f>(count), std::vector<Rgb>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    estimates.cloud.places[i] = photons.cloud.places[photons.estimated[i]];
    estimates.normals[i] = photons.normals[photons.estimated[i]];
  }
  return estimates;
}

// E at each of the estimates, whose places are known.
void estimate(const Photons& photons, const Tree& tree, float reach_squared, const PhotonMapParams& params,
              Estimates& estimates) {
  const std::vector<V3f>& places = estimates.cloud.places;
  const std::size_t neighbours = std::size_t(std::max(2, params.neighbours));
  // Where more than K photons came to one point, as in a focus, the disc has no area; rounding's has.
  const double least_squared = double(reach_squared) * 1e-10;
  std::mutex mutex;
  std::uint64_t done = 0;
  const auto estimate_range = [&](const tbb::blocked_range<std::size_t>& range) {
    NearestAlike nearest(photons.normals, neighbours);
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      // As many photons as the last disc holds are no farther than its rim is from here, and face alike if the normals
      // are the same: the search need not begin with the whole reach. Were rounding to leave one out, it begins again.
      float bound = reach_squared;
      if (nearest.full() && estimates.normals[i] == estimates.normals[i - 1]) {
        const float farthest = std::sqrt(nearest.radius_squared()) + (places[i] - places[i - 1]).length();
        bound = std::min(bound, 1.0001F * farthest * farthest);
      }
      nearest.search(tree, places[i], estimates.normals[i], bound);
      if (!nearest.full() && bound < reach_squared)
        nearest.search(tree, places[i], estimates.normals[i], reach_squared);
      const bool full = nearest.full();
      V3d sum(0, 0, 0);
      for (std::size_t k = 0; k + (full ? 1 : 0) < nearest.size(); ++k) sum += V3d(photons.powers_lm[nearest.index(k)]);
      const double radius_squared = double(full ? nearest.radius_squared() : reach_squared);
      sum /= double(pi) * std::max(radius_squared, least_squared) * double(params.photons);
      estimates.e[i] = Rgb(float(sum.x), float(sum.y), float(sum.z));
    }
    if (!params.progress) return;
    const std::lock_guard lock(mutex);
    done += range.size();
    params.progress(done, places.size());
  };
  // Ranges split in the same way at any number of threads: where one begins decides the order of its sums.
  const tbb::blocked_range<std::size_t> all(0, places.size(), 256);
  tbb::parallel_for(all, estimate_range, tbb::simple_partitioner());
}

}  // namespace

std::optional<EmissionTarget> target_in_view(const Intersector& intersector, const View& view) {
  constexpr int side = 32;
  std::vector<V3f> seen;
  for (int i = 0; i < side * side; ++i) {
    const V2f at((float(i % side) + 0.5F) / side, (float(i / side) + 0.5F) / side);
    const Ray ray = make_ray(view, V2f(at.x * float(view.width), at.y * float(view.height)));
    if (const std::optional<Hit> hit = intersector.closest(ray)) seen.push_back(ray.origin + ray.direction * hit->t);
  }
  if (seen.empty()) return std::nullopt;
  const auto middle = std::ptrdiff_t(seen.size() / 2);
  const auto median = [&](auto values) {
    std::nth_element(values.begin(), values.begin() + middle, values.end());
    return values[std::size_t(middle)];
  };
  EmissionTarget target;
  std::vector<float> values(seen.size());
  for (unsigned axis = 0; axis < 3; ++axis) {
    std::transform(seen.begin(), seen.end(), values.begin(), [&](const V3f& p) { return p[axis]; });
    target.center[axis] = median(values);
  }
  std::transform(seen.begin(), seen.end(), values.begin(), [&](const V3f& p) { return (p - target.center).length(); });
  target.radius_m = 2 * median(values);
  if (!(target.radius_m > 0)) return std::nullopt;
  return target;
}

struct PhotonMap::State {
  std::size_t photons_stored = 0;
  float reach_squared = 0;
  Estimates estimates;
  std::unique_ptr<Tree> tree;
};

PhotonMap::PhotonMap(const LitScene& lit, const PhotonMapParams& params) : state_(std::make_unique<State>()) {
  if (lit.lights.empty())
    throw Error(lit.scene->name, "nothing in it shines", "add a light, an emissive material or an environment");
  tbb::task_arena arena(params.threads > 0 ? params.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    State& state = *state_;
    const float reach = reach_radii * lit.intersector.radius_m();
    state.reach_squared = reach * reach;
    const Photons photons = put_in_order(trace(lit, params), lit.intersector.center(), lit.intersector.radius_m());
    state.photons_stored = photons.cloud.places.size();
    state.estimates = places_of_estimates(photons);
    // nanoflann builds a tree on one thread.
    std::unique_ptr<Tree> tree;
    tbb::parallel_invoke([&] { tree = std::make_unique<Tree>(3, photons.cloud, photons_a_leaf); },
                         [&] { state.tree = std::make_unique<Tree>(3, state.estimates.cloud); });
    estimate(photons, *tree, state.reach_squared, params, state.estimates);
  });
}

PhotonMap::~PhotonMap() = default;
PhotonMap::PhotonMap(PhotonMap&&) noexcept = default;
PhotonMap& PhotonMap::operator=(PhotonMap&&) noexcept = default;

Rgb PhotonMap::irradiance(const V3f& p, const V3f& n) const {
  const State& state = *state_;
  struct NearestOne {
    const std::vector<V3f>& normals;
    const V3f& n;
    float best;
    std::int64_t index = -1;
    bool addPoint(float distance_squared, std::uint32_t i) {
      if (distance_squared < best && normals[i].dot(n) >= facing_alike) {
        best = distance_squared;
        index = i;
      }
      return true;
    }
    float worstDist() const { return best; }
    bool full() const { return index >= 0; }
  } nearest{state.estimates.normals, n, state.reach_squared};
  state.tree->findNeighbors(nearest, &p.x, {});
  return nearest.index < 0 ? Rgb(0, 0, 0) : state.estimates.e[std::size_t(nearest.index)];
}

std::size_t PhotonMap::photons_stored() const { return state_->photons_stored; }
std::size_t PhotonMap::estimates() const { return state_->estimates.cloud.places.size(); }
std::size_t PhotonMap::bytes() const {
  return state_->estimates.cloud.places.size() * (2 * sizeof(V3f) + sizeof(Rgb)) +
         state_->tree->usedMemory(*state_->tree);
}

}  // namespace ivory
