#include "tracer/bake/spheres/packing.h"

#include <algorithm>
#include <cmath>
#include <limits>

// Shadows are as large as the solid that casts them, so the spheres U that stand for a solid O are to leave out as much
// as they add: what is minimised is the volume of the symmetric difference, |U \ O| + |O \ U|. On voxels with the score
// s = +1 inside, -1 outside, that is to maximise
//
//   G(U) = sum of s over the voxels in U.
//
// Spheres enter one by one where they gain most, seeded at the deepest uncovered point. Then, in rounds, each sphere in
// turn is taken out and moved to where it gains most given all others (for any centre the best radius comes from one
// pass over the voxels around, sorted by distance), which is the Lloyd iteration of the variational method; and the
// sphere that gains least is tried elsewhere (its teleportation). No step lowers G, so it ends. Parts thinner than a
// voxel have no volume to win: where they leave much of the surface uncovered, voxels that hold surface score more,
// until it is covered.

namespace ivory {

namespace {

constexpr int steps_a_voxel = 4;  // of radii

// Calls f(index, squared distance) for the voxels whose centres lie within `radius`.
template <typename F>
void for_each_voxel(const Voxels& voxels, const V3d& center, double radius, const F& f) {
  const auto first = [&](double c, double r) { return std::max(0, int(std::ceil(c - r - 0.5))); };
  const auto last = [&](double c, double r, int n) { return std::min(n - 1, int(std::floor(c + r - 0.5))); };
  const double radius2 = radius * radius;
  for (int z = first(center.z, radius); z <= last(center.z, radius, voxels.size.z); ++z) {
    const double dz = z + 0.5 - center.z;
    for (int y = first(center.y, radius); y <= last(center.y, radius, voxels.size.y); ++y) {
      const double dy = y + 0.5 - center.y;
      const double rest = radius2 - dz * dz - dy * dy;
      if (rest < 0) continue;
      const double half = std::sqrt(rest);
      std::size_t at = voxels.index(first(center.x, half), y, z);
      for (int x = first(center.x, half); x <= last(center.x, half, voxels.size.x); ++x, ++at) {
        const double dx = x + 0.5 - center.x;
        f(at, dx * dx + dy * dy + dz * dz);
      }
    }
  }
}

void cover(Voxels& voxels, const PackedSphere& sphere, int change) {
  for_each_voxel(voxels, sphere.center, sphere.radius,
                 [&](std::size_t at, double) { voxels.covered[at] = std::uint16_t(voxels.covered[at] + change); });
}

struct Candidate {
  PackedSphere sphere;
  int gain = 0;
};

// The best radius for a centre, up to `most`, given what is covered already.
Candidate best_radius(const Voxels& voxels, const V3d& center, double most) {
  for (int k = 0; k < 3; ++k) most = std::min({most, center[k], voxels.size[k] - center[k]});
  Candidate best{{center, 0}, 0};
  if (!(most > 0)) return best;
  thread_local std::vector<int> bins;
  bins.assign(std::size_t(most * steps_a_voxel) + 2, 0);
  for_each_voxel(voxels, center, most, [&](std::size_t at, double distance2) {
    if (voxels.covered[at] == 0) bins[std::size_t(std::sqrt(distance2) * steps_a_voxel)] += voxels.score[at];
  });
  int sum = 0;
  for (std::size_t i = 0; i + 1 < bins.size(); ++i) {
    sum += bins[i];
    if (sum > best.gain) best = {{center, double(i + 1) / steps_a_voxel}, sum};
  }
  return best;
}

// Pattern search over the centre from `start`, steps halved where no neighbour is better.
Candidate climb(const Voxels& voxels, const V3d& start, double radius, double first_step) {
  Candidate best = best_radius(voxels, start, radius * 1.5 + 3);
  for (double step = first_step; step >= 0.25;) {
    Candidate next = best;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        V3d center = best.sphere.center;
        center[axis] += sign * step;
        const Candidate tried = best_radius(voxels, center, best.sphere.radius + 2 * step + 1);
        if (tried.gain > next.gain) next = tried;
      }
    }
    if (next.gain > best.gain) {
      best = next;
    } else {
      step *= 0.5;
    }
  }
  return best;
}

// Centres to begin from: the uncovered voxel of positive score that lies deepest among such, and, for sheets, which
// have no depth, the one farthest from all that is covered. Chamfer distances (3 a face, 4 an edge, 5 a corner), two
// passes. Voxels beyond the padding hold nothing of the mesh.
std::vector<V3d> seeds(const Voxels& voxels, bool sheets, std::vector<std::uint16_t>& distance) {
  std::vector<V3d> result;
  const V3i low(voxels.padding, voxels.padding, voxels.padding);
  const V3i inner = voxels.size - low * 2;
  for (const bool deepest : {true, false}) {
    if (!deepest && !sheets) break;
    const auto target = [&](std::size_t at) { return voxels.score[at] > 0 && voxels.covered[at] == 0; };
    constexpr std::uint16_t far = 60000;
    for (std::size_t at = 0; at < distance.size(); ++at)
      distance[at] = (deepest ? target(at) : voxels.covered[at] == 0) ? far : 0;
    const auto pass = [&](int sign) {
      for (int k = 0; k < inner.z; ++k) {
        const int z = low.z + (sign > 0 ? k : inner.z - 1 - k);
        for (int j = 0; j < inner.y; ++j) {
          const int y = low.y + (sign > 0 ? j : inner.y - 1 - j);
          for (int i = 0; i < inner.x; ++i) {
            const int x = low.x + (sign > 0 ? i : inner.x - 1 - i);
            std::uint16_t& d = distance[voxels.index(x, y, z)];
            if (d == 0) continue;
            const auto try_neighbour = [&](int dx, int dy, int dz, int weight) {
              const int nx = x + dx;
              const int ny = y + dy;
              const int nz = z + dz;
              d = std::uint16_t(std::min<int>(d, distance[voxels.index(nx, ny, nz)] + weight));
            };
            // The 13 neighbours that this pass has been to.
            for (int dy = -1; dy <= 1; ++dy) {
              for (int dx = -1; dx <= 1; ++dx) try_neighbour(dx, dy, -sign, 3 + std::abs(dx) + std::abs(dy));
            }
            for (int dx = -1; dx <= 1; ++dx) try_neighbour(dx, -sign, 0, 3 + std::abs(dx));
            try_neighbour(-sign, 0, 0, 3);
          }
        }
      }
    };
    pass(1);
    pass(-1);
    std::uint16_t best = 0;
    V3d seed;
    for (int z = low.z; z < low.z + inner.z; ++z) {
      for (int y = low.y; y < low.y + inner.y; ++y) {
        std::size_t at = voxels.index(low.x, y, z);
        for (int x = low.x; x < low.x + inner.x; ++x, ++at) {
          if (distance[at] <= best || !target(at)) continue;
          best = distance[at];
          seed = V3d(x + 0.5, y + 0.5, z + 0.5);
        }
      }
    }
    if (best > 0) result.push_back(seed);
  }
  return result;
}

class Fitter {
 public:
  Fitter(Voxels& voxels, const SpherePackingParams& params) : voxels_(voxels), params_(params) {
    distance_.resize(voxels.score.size());
    std::fill(voxels.covered.begin(), voxels.covered.end(), std::uint16_t(0));
  }

  std::vector<PackedSphere> run() {
    while (int(spheres_.size()) < params_.count) {
      const Candidate candidate = best_new();
      if (candidate.gain <= 0) break;
      add(candidate.sphere);
      report(0.5 * double(spheres_.size()) / params_.count);
    }
    for (int round = 0; round < params_.rounds; ++round) {
      const bool moved = relax();
      const bool teleported = teleport();
      report(0.5 + 0.5 * (round + 1) / params_.rounds);
      if (!moved && !teleported) break;
    }
    return spheres_;
  }

 private:
  void report(double fraction) const {
    if (params_.progress) params_.progress(fraction);
  }
  void add(const PackedSphere& sphere) {
    cover(voxels_, sphere, 1);
    spheres_.push_back(sphere);
  }
  Candidate best_new() {
    Candidate best;
    for (const V3d& seed : seeds(voxels_, params_.sheets, distance_)) {
      const double depth = double(*std::max_element(size_begin(), size_end()));
      const Candidate candidate = climb(voxels_, seed, 0.5 * depth, 2);
      if (candidate.gain > best.gain) best = candidate;
    }
    return best;
  }
  const int* size_begin() const { return &voxels_.size.x; }
  const int* size_end() const { return &voxels_.size.x + 3; }

  // Each sphere to its best place given the others.
  bool relax() {
    bool moved = false;
    for (PackedSphere& sphere : spheres_) {
      cover(voxels_, sphere, -1);
      const int before = gain_of(sphere);
      const Candidate candidate = climb(voxels_, sphere.center, sphere.radius, 1);
      if (candidate.gain > before) {
        sphere = candidate.sphere;
        moved = true;
      }
      cover(voxels_, sphere, 1);
    }
    return moved;
  }

  // The spheres that gain least, each tried where a new one would gain most.
  bool teleport() {
    bool any = false;
    const std::size_t tries = std::max<std::size_t>(1, spheres_.size() / 16);
    for (std::size_t i = 0; i < tries && spheres_.size() > 1; ++i) {
      std::size_t least = 0;
      int least_gain = std::numeric_limits<int>::max();
      for (std::size_t k = 0; k < spheres_.size(); ++k) {
        cover(voxels_, spheres_[k], -1);
        const int gain = gain_of(spheres_[k]);
        cover(voxels_, spheres_[k], 1);
        if (gain < least_gain) {
          least_gain = gain;
          least = k;
        }
      }
      cover(voxels_, spheres_[least], -1);
      const Candidate candidate = best_new();
      const bool better = candidate.gain > least_gain;
      if (better) spheres_[least] = candidate.sphere;
      cover(voxels_, spheres_[least], 1);
      if (!better) break;
      any = true;
    }
    return any;
  }

  int gain_of(const PackedSphere& sphere) const {
    int sum = 0;
    for_each_voxel(voxels_, sphere.center, sphere.radius, [&](std::size_t at, double) {
      if (voxels_.covered[at] == 0) sum += voxels_.score[at];
    });
    return sum;
  }

  Voxels& voxels_;
  const SpherePackingParams& params_;
  std::vector<std::uint16_t> distance_;
  std::vector<PackedSphere> spheres_;
};

}  // namespace

std::vector<PackedSphere> pack_spheres(Voxels& voxels, const SpherePackingParams& params) {
  return Fitter(voxels, params).run();
}

}  // namespace ivory
