#include "tracer/bake/spheres/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "grid/base/error.h"
#include "tracer/bake/spheres/mesh_orientation.h"
#include "tracer/bake/spheres/packing.h"
#include "tracer/bake/spheres/winding_number.h"
#include "tracer/core/low_discrepancy.h"

namespace ivory {

namespace {

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
  ends.reserve(triangles.size());
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

double signed_distance(const std::vector<PackedSphere>& spheres, const V3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const PackedSphere& sphere : spheres) least = std::min(least, (p - sphere.center).length() - sphere.radius);
  return least;
}

// Distances in units of the bounding sphere's radius.
struct SurfaceErrors {
  double uncovered = 0;
  double mean = 0;
  double farthest = 0;
};
constexpr double surface_tolerance = 0.02;

SurfaceErrors surface_errors(const std::vector<PackedSphere>& spheres, const std::vector<V3d>& points,
                             double bounding_radius) {
  SurfaceErrors errors;
  for (const V3d& p : points) {
    const double d = signed_distance(spheres, p) / bounding_radius;
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
// of mesh and spheres.
void measure_volumes(const WindingNumber& winding, const Normalised& mesh, const std::vector<PackedSphere>& spheres,
                     bool is_solid, SphereFitErrors& errors) {
  V3d low(0, 0, 0);
  V3d high = mesh.size;
  for (const PackedSphere& sphere : spheres) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], sphere.center[k] - sphere.radius);
      high[k] = std::max(high[k], sphere.center[k] + sphere.radius);
    }
  }
  constexpr std::size_t count = 1U << 18U;
  std::vector<std::uint8_t> kinds(count);  // 1: in the mesh, 2: in a sphere
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      // The R3 sequence: multiples of powers of 1/1.2207..., the root of x^4 = x + 1 (Roberts 2018).
      constexpr double g = 1.2207440846057596;
      const double n = double(i) + 0.5;
      const V3d u(n / g - std::floor(n / g), n / (g * g) - std::floor(n / (g * g)),
                  n / (g * g * g) - std::floor(n / (g * g * g)));
      const V3d p(low.x + u.x * (high.x - low.x), low.y + u.y * (high.y - low.y), low.z + u.z * (high.z - low.z));
      kinds[i] = std::uint8_t((std::abs(winding.at(p)) > 0.5 ? 1 : 0) | (signed_distance(spheres, p) < 0 ? 2 : 0));
    }
  });
  double counts[4] = {0, 0, 0, 0};
  for (const std::uint8_t kind : kinds) ++counts[kind];
  const double box = (high.x - low.x) * (high.y - low.y) * (high.z - low.z) / double(count);
  const double solid = counts[1] + counts[3];
  errors.mesh_volume_m3 = solid * box * mesh.scale * mesh.scale * mesh.scale;
  // Sheets enclose next to nothing: volumes are then over the bounding sphere's.
  const double radius = bounding_radius_of(mesh);
  const double unit = is_solid ? solid : 4.0 / 3 * double(pi) * radius * radius * radius / box;
  errors.volume_outside = counts[2] / unit;
  errors.volume_uncovered = counts[1] / unit;
}

}  // namespace

namespace {

// Fraction of the points of a 32^3 grid over the mesh's box that lie inside.
double inside_fraction(const WindingNumber& winding, const V3d& size) {
  constexpr int n = 32;
  std::array<int, n> counts{};
  tbb::parallel_for(0, n, [&](int z) {
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x)
        counts[std::size_t(z)] += std::abs(winding.at(V3d(x + 0.5, y + 0.5, z + 0.5) / double(n) * size)) > 0.5 ? 1 : 0;
    }
  });
  return double(std::accumulate(counts.begin(), counts.end(), 0)) / (n * n * n);
}

// Triangles that run this way and that cancel: where turning them by parity encloses clearly more, that is what was
// meant.
WindingNumber wind(Normalised& mesh) {
  WindingNumber winding(mesh.triangles);
  std::vector<Triangle3d> turned = mesh.triangles;
  orient_by_parity(turned, mesh.size, 128);
  WindingNumber other(turned);
  if (inside_fraction(other, mesh.size) < 1.5 * inside_fraction(winding, mesh.size) + 1e-3) return winding;
  mesh.triangles = std::move(turned);
  return other;
}

}  // namespace

SphereFit fit_spheres(const Scene& scene, const SphereFitParams& params) {
  Normalised mesh = normalise(scene);
  const WindingNumber winding = wind(mesh);
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
  std::vector<PackedSphere> spheres;
  SurfaceErrors surface;
  const std::array<int, 3> weights{0, 4, 16};
  std::size_t attempt = fit.solid ? 0 : 1;
  for (;; ++attempt) {
    const int weight = weights[attempt];
    voxels.score.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      voxels.score[i] = std::int8_t((inside[i] != 0 ? 1 : -1) + (on_surface[i] != 0 ? weight : 0));
    SpherePackingParams packing;
    packing.count = params.count;
    packing.rounds = params.rounds;
    packing.sheets = weight > 0;
    packing.progress = [&](double fraction) {
      if (params.progress) params.progress((double(attempt) + fraction) / double(weights.size()));
    };
    std::vector<PackedSphere> found = pack_spheres(voxels, packing);
    for (PackedSphere& sphere : found) {
      sphere.center = (sphere.center - V3d(padding, padding, padding)) * voxel;
      sphere.radius *= voxel;
    }
    const SurfaceErrors errors =
        found.empty() ? SurfaceErrors{1, 1, 1} : surface_errors(found, samples, bounding_radius);
    // Kept where it covers clearly more than what there was.
    if (spheres.empty() || errors.uncovered < 0.75 * surface.uncovered) {
      spheres = std::move(found);
      surface = errors;
      fit.surface_weight = weight;
    }
    if (attempt + 1 == weights.size() || (!spheres.empty() && surface.uncovered < 0.4)) break;
  }
  if (spheres.empty())
    throw Error(scene.name, "has parts too thin for spheres to cover", "thicken it, or ask for more spheres");

  measure_volumes(winding, mesh, spheres, fit.solid, fit.errors);
  fit.errors.surface_uncovered = surface.uncovered;
  fit.errors.surface_mean = surface.mean;
  fit.errors.surface_farthest = surface.farthest;
  fit.errors.bounding_radius_m = bounding_radius * mesh.scale;
  // Large first: the first spheres of a list are the ones to keep where few are asked for.
  std::stable_sort(spheres.begin(), spheres.end(),
                   [](const PackedSphere& a, const PackedSphere& b) { return a.radius > b.radius; });
  fit.set.anchor_m = scene.anchor_m;
  for (const PackedSphere& sphere : spheres) {
    const V3d center = mesh.origin + sphere.center * mesh.scale;
    fit.set.spheres.push_back({V3f(center), float(sphere.radius * mesh.scale)});
  }
  return fit;
}

}  // namespace ivory
