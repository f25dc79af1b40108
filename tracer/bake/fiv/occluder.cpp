#include "tracer/bake/fiv/occluder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "grid/base/error.h"
#include "grid/base/placement.h"

namespace ivory {

namespace {

// Smallest enclosing sphere by Badoiu & Clarkson's iteration ("Smaller core-sets for balls", SODA 2003):
// the centre steps towards the farthest point, by 1/(i + 1) of the way. Good to about 1/sqrt(steps) of the radius at
// worst; the radius is that of the centre found, so the sphere always holds every point. Own code: twenty lines against
// all of CGAL.
void find_bounding_sphere(const std::vector<V3d>& points, V3d& center, double& radius) {
  constexpr int steps = 2000;
  Imath::Box3d box;
  for (const V3d& p : points) box.extendBy(p);
  center = box.center();
  const auto farthest = [&] {
    std::size_t index = 0;
    double length2 = -1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double l = (points[i] - center).length2();
      if (l > length2) {
        length2 = l;
        index = i;
      }
    }
    return std::pair(index, std::sqrt(length2));
  };
  V3d best = center;
  radius = farthest().second;
  for (int i = 1; i <= steps; ++i) {
    const auto [index, length] = farthest();
    if (length < radius) {
      radius = length;
      best = center;
    }
    center += (points[index] - center) / (i + 1);
  }
  center = best;
}

// A spherical light is no occluder: it shines by itself.
bool is_light(const Scene& scene, std::size_t instance) {
  return std::any_of(scene.sphere_lights.begin(), scene.sphere_lights.end(),
                     [&](const SphereLight& light) { return light.instance == int(instance); });
}

// Three corners a triangle of the instances marked in `is_part`, all where that is empty; spherical lights left out.
std::vector<V3d> world_points(const Scene& scene, const std::vector<bool>& is_part) {
  std::vector<V3d> points;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    if ((!is_part.empty() && !is_part[i]) || is_light(scene, i)) continue;
    const Instance& instance = scene.instances[i];
    const Imath::M44d m(instance.to_world);
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    for (const auto& triangle : mesh.triangles) {
      for (unsigned corner = 0; corner < 3; ++corner) points.push_back(V3d(mesh.positions[triangle[corner]]) * m);
    }
  }
  return points;
}

using SurfaceMoments = std::array<float, fiv_moment_count>;

// The first numbers of a FivShape. `points`: three corners a triangle.
SurfaceMoments moments_of(const std::vector<V3d>& points, const V3d& center, double radius) {
  std::array<double, 10> sums{};
  for (std::size_t i = 0; i < points.size(); i += 3) {
    const V3d a = (points[i] - center) / radius;
    const V3d b = (points[i + 1] - center) / radius;
    const V3d c = (points[i + 2] - center) / radius;
    const double area = 0.5 * (b - a).cross(c - a).length();
    const V3d middle = (a + b + c) / 3;
    // Exact over the triangle, so that it does not matter how a face is cut into triangles.
    const auto second = [&](unsigned u, unsigned v) {
      return (9 * middle[u] * middle[v] + a[u] * a[v] + b[u] * b[v] + c[u] * c[v]) / 12;
    };
    const double products[10] = {
        1,           middle.x, middle.y, middle.z, second(0, 0), second(1, 1), second(2, 2), second(0, 1), second(0, 2),
        second(1, 2)};
    for (std::size_t k = 0; k < 10; ++k) sums[k] += area * products[k];
  }
  SurfaceMoments moments{};
  moments[0] = float(sums[0]);
  for (std::size_t k = 1; k < 10; ++k) moments[k] = sums[0] > 0 ? float(sums[k] / sums[0]) : 0.0F;
  return moments;
}

FivShape shape_of(const std::vector<V3d>& points, const V3d& center, double radius) {
  std::array<V3d, fiv_reach_count> directions;
  std::size_t count = 0;
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        if (x != 0 || y != 0 || z != 0) directions[count++] = V3d(x, y, z).normalized();
      }
    }
  }
  std::array<double, fiv_reach_count> reach;
  reach.fill(-std::numeric_limits<double>::infinity());
  for (const V3d& point : points) {
    const V3d p = (point - center) / radius;
    for (std::size_t k = 0; k < fiv_reach_count; ++k) reach[k] = std::max(reach[k], p.dot(directions[k]));
  }
  FivShape shape{};
  const SurfaceMoments moments = moments_of(points, center, radius);
  std::copy(moments.begin(), moments.end(), shape.begin());
  for (std::size_t k = 0; k < fiv_reach_count; ++k) shape[fiv_moment_count + k] = float(reach[k]);
  return shape;
}

}  // namespace

FivOccluder make_fiv_occluder(const Scene& scene) {
  const std::vector<V3d> points = world_points(scene, {});
  if (points.empty()) throw Error(scene.name, "has no triangles, so it hides nothing", "give a mesh");
  V3d center;
  double radius = 0;
  find_bounding_sphere(points, center, radius);
  if (!(radius > 0)) throw Error(scene.name, "has no extent, so it hides nothing", "give a mesh of some size");
  FivOccluder out;
  out.scene = scene;
  out.scene.lights.clear();
  out.scene.instances.clear();
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    if (!is_light(scene, i)) out.scene.instances.push_back(scene.instances[i]);
  }
  out.scene.sphere_lights.clear();
  out.scene.environment.reset();
  out.center_m = V3f(center);
  out.anchor_m = scene.anchor_m;
  out.scene.anchor_m = V3d(0, 0, 0);
  out.shape = shape_of(points, center, radius);
  // Rounded up: every point stays within the unit sphere.
  out.radius_m = float(radius * (1 + 1e-5));
  for (Instance& instance : out.scene.instances) {
    Imath::M44d m(instance.to_world);
    m = m * Imath::M44d().setTranslation(-V3d(out.center_m)) * Imath::M44d().setScale(1 / double(out.radius_m));
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) instance.to_world[row][column] = float(m[row][column]);
    }
  }
  return out;
}

std::optional<FivPlacement> find_placement(const FivTable& table, const Scene& scene, const std::vector<bool>& is_part,
                                           double turn_rad) {
  std::vector<V3d> points = world_points(scene, is_part);
  if (points.empty()) return std::nullopt;
  const Imath::M33d turn(turn_about_y(turn_rad));
  if (turn_rad != 0) {
    for (V3d& point : points) point = point * turn.transposed();
  }
  // About any centre and radius: the first of the moments then gives those that the table's numbers belong to.
  const V3d& any = points.front();
  const SurfaceMoments moved = moments_of(points, any, 1);
  const double radius = std::sqrt(double(moved[0]) / double(table.shape[0]));
  const V3d centroid = any + V3d(double(moved[1]), double(moved[2]), double(moved[3]));
  const V3d center = centroid - V3d(V3f(table.shape[1], table.shape[2], table.shape[3])) * radius;
  if (!(radius > 0) || !std::isfinite(radius)) return std::nullopt;
  const FivShape shape = shape_of(points, center, radius);
  // Moments and reaches in bounding radii of one mesh stored twice differ by rounding; of meshes turned by a degree by
  // more, unless turning leaves them as they were.
  constexpr float tolerance = 1e-3F;
  for (std::size_t k = 1; k < shape.size(); ++k) {
    if (!(std::abs(shape[k] - table.shape[k]) < tolerance)) return std::nullopt;
  }
  return FivPlacement{&table, V3f(turn_rad != 0 ? center * turn : center), float(radius)};
}

std::optional<TurnedPlacement> find_turned_placement(const FivTable& table, const Scene& scene,
                                                     const std::vector<bool>& is_part) {
  std::vector<double> candidates{0};
  const std::size_t first = std::size_t(std::find(is_part.begin(), is_part.end(), true) - is_part.begin());
  if (first < scene.instances.size()) {
    // A turn about +Y after any other that the table's mesh has too.
    const M44f& m = scene.instances[first].to_world;
    candidates.push_back(std::atan2(double(m[2][0]) - double(m[0][2]), double(m[0][0]) + double(m[2][2])));
  }
  // The longest axis seen from above, from +X towards +Z: a turn takes its angle off it.
  const auto axis_of = [](const auto& s) {
    return 0.5 * std::atan2(2 * (double(s[8]) - double(s[1]) * double(s[3])),
                            double(s[4]) - double(s[1]) * double(s[1]) - double(s[6]) + double(s[3]) * double(s[3]));
  };
  if (const std::vector<V3d> points = world_points(scene, is_part); !points.empty()) {
    const double by_axis = axis_of(table.shape) - axis_of(moments_of(points, points.front(), 1));
    candidates.push_back(by_axis);
    candidates.push_back(by_axis + double(pi));
  }
  for (const double turn_rad : candidates) {
    if (const std::optional<FivPlacement> at = find_placement(table, scene, is_part, turn_rad))
      return TurnedPlacement{*at, turn_rad};
  }
  return std::nullopt;
}

}  // namespace ivory
