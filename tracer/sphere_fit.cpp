#include "tracer/sphere_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "grid/error.h"
#include "tracer/low_discrepancy.h"
#include "tracer/winding_number.h"

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

// In units of voxels, the grid's corner at the origin.
struct Ball {
  V3d center;
  double radius = 0;
};

constexpr int steps_a_voxel = 4;  // of radii

struct Voxels {
  V3i size;
  int padding = 1;  // voxels around the mesh's box, at least 1
  std::vector<std::int8_t> score;
  std::vector<std::uint16_t> covered;  // by how many balls

  std::size_t index(int x, int y, int z) const {
    return (std::size_t(z) * std::size_t(size.y) + std::size_t(y)) * std::size_t(size.x) + std::size_t(x);
  }
};

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

void cover(Voxels& voxels, const Ball& ball, int change) {
  for_each_voxel(voxels, ball.center, ball.radius,
                 [&](std::size_t at, double) { voxels.covered[at] = std::uint16_t(voxels.covered[at] + change); });
}

struct Candidate {
  Ball ball;
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
        V3d center = best.ball.center;
        center[axis] += sign * step;
        const Candidate tried = best_radius(voxels, center, best.ball.radius + 2 * step + 1);
        if (tried.gain > next.gain) next = tried;
      }
    }
    if (next.gain > best.gain)
      best = next;
    else
      step *= 0.5;
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
  Fitter(Voxels& voxels, const SphereFitParams& params, bool sheets, double tried_before, double tries)
      : voxels_(voxels), params_(params), sheets_(sheets), progress_start_(tried_before), progress_scale_(1 / tries) {
    distance_.resize(voxels.score.size());
    std::fill(voxels.covered.begin(), voxels.covered.end(), std::uint16_t(0));
  }

  std::vector<Ball> run() {
    while (int(balls_.size()) < params_.count) {
      const Candidate candidate = best_new();
      if (candidate.gain <= 0) break;
      add(candidate.ball);
      report(0.5 * double(balls_.size()) / params_.count);
    }
    for (int round = 0; round < params_.rounds; ++round) {
      const bool moved = relax();
      const bool teleported = teleport();
      report(0.5 + 0.5 * (round + 1) / params_.rounds);
      if (!moved && !teleported) break;
    }
    return balls_;
  }

 private:
  void report(double fraction) const {
    if (params_.progress) params_.progress(progress_start_ + fraction * progress_scale_);
  }
  void add(const Ball& ball) {
    cover(voxels_, ball, 1);
    balls_.push_back(ball);
  }
  Candidate best_new() {
    Candidate best;
    for (const V3d& seed : seeds(voxels_, sheets_, distance_)) {
      const double depth = double(*std::max_element(size_begin(), size_end()));
      const Candidate candidate = climb(voxels_, seed, 0.5 * depth, 2);
      if (candidate.gain > best.gain) best = candidate;
    }
    return best;
  }
  const int* size_begin() const { return &voxels_.size.x; }
  const int* size_end() const { return &voxels_.size.x + 3; }

  // Each ball to its best place given the others.
  bool relax() {
    bool moved = false;
    for (Ball& ball : balls_) {
      cover(voxels_, ball, -1);
      const int before = gain_of(ball);
      const Candidate candidate = climb(voxels_, ball.center, ball.radius, 1);
      if (candidate.gain > before) {
        ball = candidate.ball;
        moved = true;
      }
      cover(voxels_, ball, 1);
    }
    return moved;
  }

  // The balls that gain least, each tried where a new one would gain most.
  bool teleport() {
    bool any = false;
    const std::size_t tries = std::max<std::size_t>(1, balls_.size() / 16);
    for (std::size_t i = 0; i < tries && balls_.size() > 1; ++i) {
      std::size_t least = 0;
      int least_gain = std::numeric_limits<int>::max();
      for (std::size_t k = 0; k < balls_.size(); ++k) {
        cover(voxels_, balls_[k], -1);
        const int gain = gain_of(balls_[k]);
        cover(voxels_, balls_[k], 1);
        if (gain < least_gain) {
          least_gain = gain;
          least = k;
        }
      }
      cover(voxels_, balls_[least], -1);
      const Candidate candidate = best_new();
      const bool better = candidate.gain > least_gain;
      if (better) balls_[least] = candidate.ball;
      cover(voxels_, balls_[least], 1);
      if (!better) break;
      any = true;
    }
    return any;
  }

  int gain_of(const Ball& ball) const {
    int sum = 0;
    for_each_voxel(voxels_, ball.center, ball.radius, [&](std::size_t at, double) {
      if (voxels_.covered[at] == 0) sum += voxels_.score[at];
    });
    return sum;
  }

  Voxels& voxels_;
  const SphereFitParams& params_;
  bool sheets_;
  double progress_start_;
  double progress_scale_;
  std::vector<std::uint16_t> distance_;
  std::vector<Ball> balls_;
};

// The mesh in units of its own longest side, its box's low corner at the origin.
struct Normalised {
  std::vector<Triangle3d> triangles;
  V3d origin;
  double scale = 1;  // metres a unit
  V3d size;
};

Normalised normalise(const Scene& scene) {
  Normalised result;
  V3d low(std::numeric_limits<double>::infinity());
  V3d high(-std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    if (std::any_of(scene.sphere_lights.begin(), scene.sphere_lights.end(),
                    [&](const SphereLight& light) { return light.instance == int(i); }))
      continue;
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    const Imath::M44d m(instance.to_world);
    for (const auto& t : mesh.triangles) {
      Triangle3d triangle{V3d(mesh.positions[t.x]) * m, V3d(mesh.positions[t.y]) * m, V3d(mesh.positions[t.z]) * m};
      if (m.determinant() < 0) std::swap(triangle[1], triangle[2]);
      if (!((triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).length2() > 0)) continue;
      for (const V3d& v : triangle) {
        for (int k = 0; k < 3; ++k) {
          low[k] = std::min(low[k], v[k]);
          high[k] = std::max(high[k], v[k]);
        }
      }
      result.triangles.push_back(triangle);
    }
  }
  if (result.triangles.empty()) throw Error(scene.name, "has no triangle with area", "give a mesh to fit spheres to");
  const V3d extent = high - low;
  result.scale = std::max({extent.x, extent.y, extent.z});
  if (!std::isfinite(result.scale) || result.scale < 1e-30 || result.scale > 1e9)
    throw Error(scene.name, "is too small or too large to fit spheres to", "scale it");
  result.origin = low;
  result.size = extent / result.scale;
  for (Triangle3d& t : result.triangles) {
    for (V3d& v : t) v = (v - low) / result.scale;
  }
  return result;
}

// Points on the mesh, evenly spread by area.
std::vector<V3d> surface_samples(const std::vector<Triangle3d>& triangles, std::size_t count) {
  std::vector<double> ends;
  double area = 0;
  for (const Triangle3d& t : triangles) ends.push_back(area += 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).length());
  std::vector<V3d> points;
  points.reserve(count);
  std::size_t at = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double where = area * (double(i) + 0.5) / double(count);
    while (at + 1 < ends.size() && ends[at] < where) ++at;
    const auto u = sobol_point(std::uint32_t(i), 1);
    const double r = std::sqrt(double(u[0]) * 0x1p-32);
    const double b = double(u[1]) * 0x1p-32;
    const Triangle3d& t = triangles[at];
    points.push_back(t[0] * (1 - r) + t[1] * (r * (1 - b)) + t[2] * (r * b));
  }
  return points;
}

double signed_distance(const std::vector<Ball>& balls, const V3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const Ball& ball : balls) least = std::min(least, (p - ball.center).length() - ball.radius);
  return least;
}

// Distances in units of the bounding sphere's radius.
struct SurfaceErrors {
  double uncovered = 0;
  double mean = 0;
  double farthest = 0;
};
constexpr double surface_tolerance = 0.02;

SurfaceErrors surface_errors(const std::vector<Ball>& balls, const std::vector<V3d>& points, double bounding_radius) {
  SurfaceErrors errors;
  for (const V3d& p : points) {
    const double d = signed_distance(balls, p) / bounding_radius;
    errors.mean += std::abs(d) / double(points.size());
    errors.farthest = std::max(errors.farthest, d);
    errors.uncovered += d > surface_tolerance ? 1.0 / double(points.size()) : 0;
  }
  return errors;
}

// Half the diagonal, which bounds any part of the mesh about the box's centre.
double bounding_radius_of(const Normalised& mesh) { return 0.5 * mesh.size.length(); }

int choose_resolution(const SphereFitParams& params) {
  if (params.resolution > 0) return std::clamp(params.resolution, 16, 192);
  return std::clamp(int(64 * std::cbrt(params.count / 32.0)), 48, 160);
}

// The fit's own voxels are too kind a judge: volumes are measured on points of a low-discrepancy sequence over the box
// of mesh and balls.
void measure_volumes(const WindingNumber& winding, const Normalised& mesh, const std::vector<Ball>& balls,
                     SphereFitErrors& errors) {
  V3d low(0, 0, 0);
  V3d high = mesh.size;
  for (const Ball& ball : balls) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], ball.center[k] - ball.radius);
      high[k] = std::max(high[k], ball.center[k] + ball.radius);
    }
  }
  constexpr std::size_t count = 1U << 18U;
  std::vector<std::uint8_t> kinds(count);  // 1: in the mesh, 2: in a ball
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      // The R3 sequence: multiples of powers of 1/1.2207..., the root of x^4 = x + 1 (Roberts 2018).
      constexpr double g = 1.2207440846057596;
      const double n = double(i) + 0.5;
      const V3d u(n / g - std::floor(n / g), n / (g * g) - std::floor(n / (g * g)),
                  n / (g * g * g) - std::floor(n / (g * g * g)));
      const V3d p(low.x + u.x * (high.x - low.x), low.y + u.y * (high.y - low.y), low.z + u.z * (high.z - low.z));
      kinds[i] = std::uint8_t((std::abs(winding.at(p)) > 0.5 ? 1 : 0) | (signed_distance(balls, p) < 0 ? 2 : 0));
    }
  });
  double counts[4] = {0, 0, 0, 0};
  for (const std::uint8_t kind : kinds) ++counts[kind];
  const double box = (high.x - low.x) * (high.y - low.y) * (high.z - low.z) / double(count);
  const double solid = counts[1] + counts[3];
  errors.mesh_volume_m3 = solid * box * mesh.scale * mesh.scale * mesh.scale;
  // Sheets enclose nothing: volumes are then over the bounding sphere's.
  const double radius = bounding_radius_of(mesh);
  const double unit = solid > 0 ? solid : 4.0 / 3 * double(pi) * radius * radius * radius / box;
  errors.volume_outside = counts[2] / unit;
  errors.volume_uncovered = counts[1] / unit;
}

}  // namespace

SphereFit fit_spheres(const Scene& scene, const SphereFitParams& params) {
  const Normalised mesh = normalise(scene);
  const WindingNumber winding(mesh.triangles);
  SphereFit fit;
  fit.resolution = choose_resolution(params);
  const double voxel = 1.0 / fit.resolution;
  const int padding = fit.resolution / 6 + 2;
  Voxels voxels;
  voxels.padding = padding;
  for (int k = 0; k < 3; ++k) voxels.size[k] = std::max(1, int(std::ceil(mesh.size[k] / voxel))) + 2 * padding;
  const std::size_t count = voxels.index(0, 0, voxels.size.z);
  voxels.covered.assign(count, 0);
  std::vector<std::uint8_t> inside(count, 0);
  tbb::parallel_for(tbb::blocked_range<int>(padding, voxels.size.z - padding),
                    [&](const tbb::blocked_range<int>& range) {
                      for (int z = range.begin(); z < range.end(); ++z) {
                        for (int y = padding; y < voxels.size.y - padding; ++y) {
                          for (int x = padding; x < voxels.size.x - padding; ++x) {
                            const V3d p = V3d(x - padding + 0.5, y - padding + 0.5, z - padding + 0.5) * voxel;
                            inside[voxels.index(x, y, z)] = std::abs(winding.at(p)) > 0.5 ? 1 : 0;
                          }
                        }
                      }
                    });
  std::vector<std::uint8_t> on_surface(count, 0);
  std::size_t surface_voxels = 0;
  // Some ten points a voxel of surface at most; enough that none is missed by chance often.
  const std::vector<V3d> dense =
      surface_samples(mesh.triangles, std::size_t(fit.resolution) * std::size_t(fit.resolution) * 40);
  for (const V3d& p : dense) {
    int cell[3];
    for (int k = 0; k < 3; ++k) cell[k] = std::min(int(p[k] / voxel), voxels.size[k] - 2 * padding - 1) + padding;
    std::uint8_t& on = on_surface[voxels.index(cell[0], cell[1], cell[2])];
    surface_voxels += on == 0 ? 1U : 0U;
    on = 1;
  }
  const auto inside_voxels = std::size_t(std::count(inside.begin(), inside.end(), std::uint8_t(1)));
  fit.solid = inside_voxels * 4 > surface_voxels;

  const std::vector<V3d> samples = surface_samples(mesh.triangles, 20'000);
  const double bounding_radius = bounding_radius_of(mesh);
  std::vector<Ball> balls;
  SurfaceErrors surface;
  const std::array<int, 3> weights{0, 4, 16};
  std::size_t attempt = fit.solid ? 0 : 1;
  for (;; ++attempt) {
    const int weight = weights[attempt];
    voxels.score.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      voxels.score[i] = std::int8_t((inside[i] != 0 ? 1 : -1) + (on_surface[i] != 0 ? weight : 0));
    Fitter fitter(voxels, params, weight > 0, double(attempt) / double(weights.size()), double(weights.size()));
    std::vector<Ball> found = fitter.run();
    for (Ball& ball : found) {
      ball.center = (ball.center - V3d(padding, padding, padding)) * voxel;
      ball.radius *= voxel;
    }
    const SurfaceErrors errors =
        found.empty() ? SurfaceErrors{1, 1, 1} : surface_errors(found, samples, bounding_radius);
    // Kept where it covers clearly more than what there was.
    if (balls.empty() || errors.uncovered < 0.75 * surface.uncovered) {
      balls = std::move(found);
      surface = errors;
      fit.surface_weight = weight;
    }
    if (attempt + 1 == weights.size() || (!balls.empty() && surface.uncovered < 0.4)) break;
  }
  if (balls.empty())
    throw Error(scene.name, "has parts too thin for spheres to cover", "thicken it, or ask for more --count");

  measure_volumes(winding, mesh, balls, fit.errors);
  fit.errors.surface_uncovered = surface.uncovered;
  fit.errors.surface_mean = surface.mean;
  fit.errors.surface_farthest = surface.farthest;
  fit.errors.bounding_radius_m = bounding_radius * mesh.scale;
  // Large first: the first spheres of a list are the ones to keep where few are asked for.
  std::stable_sort(balls.begin(), balls.end(), [](const Ball& a, const Ball& b) { return a.radius > b.radius; });
  for (const Ball& ball : balls) {
    const V3d center = mesh.origin + ball.center * mesh.scale;
    fit.set.spheres.push_back({V3f(center), float(ball.radius * mesh.scale)});
  }
  return fit;
}

}  // namespace ivory
