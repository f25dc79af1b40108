#include "tracer/bake/fiv/inside.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "grid/base/circle.h"

namespace ivory {

namespace {

constexpr int test_rays = 32;
constexpr double least_hidden = 0.5;

// Evenly over the sphere (Fibonacci's lattice).
V3f test_direction(int i) {
  const float z = 1 - (2 * float(i) + 1) / test_rays;
  constexpr double golden_turn = 0.38196601125010515;
  const V2f around = V2f(on_unit_circle(golden_turn * i)) * std::sqrt(1 - z * z);
  return {around.x, z, around.y};
}

// Six times the volume that the triangles enclose by their winding.
double signed_volume(const Scene& scene) {
  double volume = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    const double side = instance.to_world.determinant() < 0 ? -1 : 1;
    for (const auto& t : mesh.triangles) {
      const V3d a(mesh.positions[t.x] * instance.to_world);
      const V3d b(mesh.positions[t.y] * instance.to_world);
      const V3d c(mesh.positions[t.z] * instance.to_world);
      volume += side * a.dot(b.cross(c));
    }
  }
  return volume;
}

}  // namespace

std::vector<char> find_inside(const Intersector& object, const std::vector<V3f>& positions,
                              std::span<const double> hidden) {
  const float out_side = signed_volume(object.scene()) < 0 ? -1.0F : 1.0F;
  std::vector<char> inside(positions.size(), 0);
  tbb::parallel_for(std::size_t(0), positions.size(), [&](std::size_t i) {
    if (hidden[i] < least_hidden) return;
    int inner = 0;
    for (int k = 0; k < test_rays; ++k) {
      Ray ray;
      ray.origin = positions[i];
      ray.direction = test_direction(k);
      ray.blocking_coverage = half_coverage;
      const std::optional<Hit> hit = object.closest(ray);
      if (hit && out_side * hit->ng.dot(ray.direction) > 0) ++inner;
    }
    inside[i] = 2 * inner > test_rays ? 1 : 0;
  });
  return inside;
}

void fill_inside(FivTable& table, std::vector<char> inside) {
  const V3i& size = table.size;
  const auto numbers = std::size_t(3 * fiv_function_count(table.hemispheres));
  const auto at = [&](int azimuth, int polar, int distance) {
    return (std::size_t(distance) * std::size_t(size.y) + std::size_t(polar)) * std::size_t(size.x) +
           std::size_t(azimuth);
  };
  if (std::find(inside.begin(), inside.end(), 0) == inside.end()) return;
  bool left = true;
  while (left) {
    left = false;
    const std::vector<char> before = inside;
    for (int distance = 0; distance < size.z; ++distance) {
      for (int polar = 0; polar < size.y; ++polar) {
        for (int azimuth = 0; azimuth < size.x; ++azimuth) {
          const std::size_t sample = at(azimuth, polar, distance);
          if (before[sample] == 0) continue;
          std::array<double, 36> sums{};
          int neighbours = 0;
          const auto add = [&](int a, int p, int d) {
            if (p < 0 || p >= size.y || d < 0 || d >= size.z) return;
            const std::size_t other = at((a + size.x) % size.x, p, d);
            if (before[other] != 0) return;
            // What interpolation works on: values over the falloff.
            const float scale =
                fiv_falloff(table.radii[std::size_t(distance)]) / fiv_falloff(table.radii[std::size_t(d)]);
            for (std::size_t i = 0; i < numbers; ++i) sums[i] += double(table.values[other * numbers + i] * scale);
            ++neighbours;
          };
          add(azimuth - 1, polar, distance);
          add(azimuth + 1, polar, distance);
          add(azimuth, polar - 1, distance);
          add(azimuth, polar + 1, distance);
          add(azimuth, polar, distance - 1);
          add(azimuth, polar, distance + 1);
          left = true;
          if (neighbours == 0) continue;
          for (std::size_t i = 0; i < numbers; ++i) table.values[sample * numbers + i] = float(sums[i] / neighbours);
          inside[sample] = 0;
        }
      }
    }
  }
}

}  // namespace ivory
