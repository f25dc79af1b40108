#include "tools/stability/scenes.h"

#include <cassert>
#include <cmath>

#include "grid/field/resolve.h"

namespace ivory {

Scene make_chambers(const Chambers& c) {
  Scene scene;
  scene.name = "two chambers";
  const int lit = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F), Rgb(1, 1, 1));
  const int dark = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
  const float h = c.side_m / 2;
  add_mesh(scene, make_room(V3f(-h, -h, -h), V3f(c.wall_x_m - c.thickness_m / 2, h, h), lit), c.to_world);
  add_mesh(scene, make_room(V3f(c.wall_x_m + c.thickness_m / 2, -h, -h), V3f(h, h, h), dark), c.to_world);
  return scene;
}

Scene make_sheet_chambers(const Chambers& c) {
  assert(c.thickness_m == 0);
  Scene scene;
  scene.name = "two chambers and a sheet";
  const int lit = add_lambert(scene, Rgb(0, 0, 0), Rgb(2, 2, 2));
  const int dark = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
  const int sheet = add_lambert(scene, Rgb(1, 1, 1), Rgb(0, 0, 0), true);
  const float h = c.side_m / 2;
  // Without the face at the sheet: -x of a room are its first two triangles, +x the next.
  Mesh left = make_room(V3f(-h, -h, -h), V3f(c.wall_x_m, h, h), lit);
  left.triangles.erase(left.triangles.begin() + 2, left.triangles.begin() + 4);
  Mesh right = make_room(V3f(c.wall_x_m, -h, -h), V3f(h, h, h), dark);
  right.triangles.erase(right.triangles.begin(), right.triangles.begin() + 2);
  add_mesh(scene, std::move(left), c.to_world);
  add_mesh(scene, std::move(right), c.to_world);
  add_mesh(scene, make_quad({c.wall_x_m, -h, -h}, {0, 2 * h, 0}, {0, 0, 2 * h}, sheet), c.to_world);
  return scene;
}

namespace {

std::vector<ProbePoint> wall_points(const Chambers& c, int count, float x, const V3f& normal) {
  std::vector<ProbePoint> points;
  V3f n;
  c.to_world.multDirMatrix(normal, n);
  n.normalize();
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      // In steps that are no fraction of a voxel's.
      const float y = (float(i) + 0.437F) / float(count) - 0.5F;
      const float z = (float(j) + 0.561F) / float(count) - 0.5F;
      points.push_back({V3f(x, 0.98F * c.side_m * y, 0.98F * c.side_m * z) * c.to_world, n});
    }
  }
  return points;
}

}  // namespace

std::vector<ProbePoint> lit_wall_points(const Chambers& c, int count) {
  return wall_points(c, count, c.wall_x_m - c.thickness_m / 2, V3f(-1, 0, 0));
}

std::vector<ProbePoint> dark_wall_points(const Chambers& c, int count) {
  return wall_points(c, count, c.wall_x_m + c.thickness_m / 2, V3f(1, 0, 0));
}

double mean_share(const LitScene& world, const IrradianceGrid& grid, Guard guard,
                  const std::vector<ProbePoint>& points) {
  double sum = 0;
  for (const ProbePoint& at : points)
    sum += double(lookup_irradiance(grid, &world.intersector, at.p, at.n, at.n, {.guard = guard}).x);
  return sum / double(points.size()) / double(chamber_irradiance);
}

IrradianceGrid bake_all_light(const LitScene& world, GridBakeParams params) {
  params.include_direct = true;
  return resolve(bake_grid_sums(world, params));
}

double surface_area_m2(const Mesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const V3d a(mesh.positions[t.x]);
    area += (V3d(mesh.positions[t.y]) - a).cross(V3d(mesh.positions[t.z]) - a).length() / 2;
  }
  return area;
}

double polygon_irradiance(const std::vector<V3d>& corners, const V3d& p, const V3d& n) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const V3d a = corners[i] - p;
    const V3d b = corners[(i + 1) % corners.size()] - p;
    const V3d c = a.cross(b);
    const double length = c.length();
    if (length > 0) sum += std::atan2(length, a.dot(b)) * c.dot(n) / length;
  }
  return std::abs(sum) / 2;
}

double ball_irradiance(double cosine, double sine2) {
  if (cosine * cosine >= sine2) return pi_d * sine2 * std::max(0.0, cosine);
  const double sine = std::sqrt(1 - cosine * cosine);
  const double x = std::sqrt(1 / sine2 - 1);
  const double y = -x * cosine / sine;
  const double root = sine * std::sqrt(1 - y * y);
  return (cosine * std::acos(y) - x * root) * sine2 + std::atan(root / x);
}

}  // namespace ivory
