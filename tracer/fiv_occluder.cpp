#include "tracer/fiv_occluder.h"

#include <cmath>
#include <utility>

#include "grid/error.h"

namespace ivory {

namespace {

// Smallest enclosing sphere by Badoiu & Clarkson's iteration ("Smaller core-sets for balls", SODA 2003):
// the centre steps towards the farthest point, by 1/(i + 1) of the way. Good to about 1/sqrt(steps) of the radius at
// worst; the radius is that of the centre found, so the sphere always holds every point.
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

// Three corners a triangle of the instances marked in `is_part`, all where that is empty.
std::vector<V3d> world_points(const Scene& scene, const std::vector<bool>& is_part) {
  std::vector<V3d> points;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    if (!is_part.empty() && !is_part[i]) continue;
    const Instance& instance = scene.instances[i];
    const Imath::M44d m(instance.to_world);
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    for (const auto& triangle : mesh.triangles) {
      for (unsigned corner = 0; corner < 3; ++corner) points.push_back(V3d(mesh.positions[triangle[corner]]) * m);
    }
  }
  return points;
}

// `points`: three corners a triangle.
FivShape shape_of(const std::vector<V3d>& points, const V3d& center, double radius) {
  std::array<double, 10> sums{};
  for (std::size_t i = 0; i < points.size(); i += 3) {
    const V3d a = (points[i] - center) / radius;
    const V3d b = (points[i + 1] - center) / radius;
    const V3d c = (points[i + 2] - center) / radius;
    const double area = 0.5 * (b - a).cross(c - a).length();
    const V3d middle = (a + b + c) / 3;
    const double products[10] = {1,
                                 middle.x,
                                 middle.y,
                                 middle.z,
                                 middle.x * middle.x,
                                 middle.y * middle.y,
                                 middle.z * middle.z,
                                 middle.x * middle.y,
                                 middle.x * middle.z,
                                 middle.y * middle.z};
    for (std::size_t k = 0; k < 10; ++k) sums[k] += area * products[k];
  }
  FivShape shape{};
  shape[0] = float(sums[0]);
  for (std::size_t k = 1; k < 10; ++k) shape[k] = sums[0] > 0 ? float(sums[k] / sums[0]) : 0.0F;
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
  out.scene.environment.reset();
  out.center_m = V3f(center);
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

std::optional<FivPlacement> find_placement(const FivTable& table, const Scene& scene,
                                           const std::vector<bool>& is_part) {
  const std::vector<V3d> points = world_points(scene, is_part);
  if (points.empty()) return std::nullopt;
  // About any centre and radius: the first of the moments then gives those that the table's numbers belong to.
  const V3d any = points.front();
  const FivShape moved = shape_of(points, any, 1);
  const double radius = std::sqrt(double(moved[0]) / double(table.shape[0]));
  const V3d centroid = any + V3d(double(moved[1]), double(moved[2]), double(moved[3]));
  const V3d center = centroid - V3d(V3f(table.shape[1], table.shape[2], table.shape[3])) * radius;
  if (!(radius > 0) || !std::isfinite(radius)) return std::nullopt;
  const FivShape shape = shape_of(points, center, radius);
  // Moments in bounding radii of one mesh stored twice differ by rounding; meshes turned by a degree by more.
  constexpr float tolerance = 1e-3F;
  for (std::size_t k = 1; k < shape.size(); ++k) {
    if (!(std::abs(shape[k] - table.shape[k]) < tolerance)) return std::nullopt;
  }
  return FivPlacement{&table, V3f(center), float(radius)};
}

}  // namespace ivory
