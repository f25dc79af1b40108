#include "tools/stability/measure_fiv.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>

#include "tracer/bake/fiv/directions.h"
#include "tracer/bake/fiv/gather.h"
#include "tracer/bake/fiv/inside.h"

namespace ivory {

namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::vector<FivPlacement> placements(const FivTable& table, const std::vector<V3f>& copies) {
  std::vector<FivPlacement> out;
  out.reserve(copies.size());
  for (const V3f& copy : copies) out.push_back({&table, copy, 1});
  return out;
}

}  // namespace

std::vector<V3f> plane_receivers(const FivPlane& plane) {
  // Any two axes in the plane will do, but the same ones for planes that face alike.
  const V3f side = std::abs(plane.n.x) < 0.9F ? V3f(1, 0, 0) : V3f(0, 0, 1);
  const V3f right = (side - plane.n * side.dot(plane.n)).normalized();
  const V3f down = right.cross(plane.n);
  std::vector<V3f> receivers;
  for (int row = 0; row < plane.resolution; ++row) {
    for (int column = 0; column < plane.resolution; ++column) {
      const float x = (2 * (float(column) + 0.5F) / float(plane.resolution) - 1) * plane.half_side;
      const float y = (2 * (float(row) + 0.5F) / float(plane.resolution) - 1) * plane.half_side;
      receivers.push_back(plane.point + right * x + down * y);
    }
  }
  return receivers;
}

FivReference reference_by_rays(const FivOccluder& occluder, const CubeMap& environment, const FivPlane& plane,
                               const std::vector<V3f>& copies) {
  const Intersector object(occluder.scene);
  const FivDirections lights = make_fiv_directions(environment);
  const std::vector<V3f> receivers = plane_receivers(plane);
  FivReference out;
  out.e.assign(receivers.size(), Rgb(0, 0, 0));
  out.unshadowed = Rgb(0, 0, 0);
  for (std::size_t k = 0; k < lights.w.size(); ++k)
    out.unshadowed += lights.power[k] * std::max(0.0F, plane.n.dot(lights.w[k]));
  tbb::parallel_for(std::size_t(0), receivers.size(), [&](std::size_t i) {
    for (std::size_t k = 0; k < lights.w.size(); ++k) {
      const float cosine = plane.n.dot(lights.w[k]);
      if (cosine <= 0 || is_black(lights.power[k])) continue;
      const bool hidden = std::any_of(copies.begin(), copies.end(), [&](const V3f& copy) {
        Ray ray;
        ray.origin = receivers[i] - copy;
        ray.direction = lights.w[k];
        // The mesh lies in the unit sphere; most rays miss it where there are many copies.
        const float along = ray.origin.dot(ray.direction);
        if ((ray.origin - ray.direction * along).length2() > 1.0001F) return false;
        return object.transmittance(ray) <= 0.5F;
      });
      if (!hidden) out.e[i] += lights.power[k] * cosine;
    }
  });
  out.open.assign(receivers.size(), true);
  const std::vector<double> all_hidden(receivers.size(), 1.0);
  for (const V3f& copy : copies) {
    std::vector<V3f> moved;
    moved.reserve(receivers.size());
    for (const V3f& p : receivers) moved.push_back(p - copy);
    const std::vector<char> inside = find_inside(object, moved, all_hidden);
    for (std::size_t i = 0; i < inside.size(); ++i) out.open[i] = out.open[i] && inside[i] == 0;
  }
  return out;
}

std::vector<Rgb> irradiance_by_table(const FivTable& table, const FivPlane& plane, const std::vector<V3f>& copies,
                                     const Rgb& unshadowed, const FivLightParams& params) {
  const std::vector<FivPlacement> occluders = placements(table, copies);
  std::vector<Rgb> e;
  for (const V3f& p : plane_receivers(plane))
    e.push_back(fiv_irradiance(occluders, p, plane.n, -1, unshadowed, params));
  return e;
}

double shadow_nrmse(const std::vector<Rgb>& e, const FivReference& reference) {
  double squares = 0;
  double count = 0;
  float low = std::numeric_limits<float>::infinity();
  float high = -low;
  for (std::size_t i = 0; i < e.size(); ++i) {
    if (!reference.open[i]) continue;
    for (unsigned c = 0; c < 3; ++c) {
      const double difference = double(e[i][c]) - double(reference.e[i][c]);
      squares += difference * difference;
      ++count;
      low = std::min(low, reference.e[i][c]);
      high = std::max(high, reference.e[i][c]);
    }
  }
  return std::sqrt(squares / count) / double(high - low);
}

CubeMap one_light(int size) {
  CubeMap map{size, std::vector<Rgb>(std::size_t(6) * std::size_t(size) * std::size_t(size), Rgb(0, 0, 0))};
  map.texels[cube_texel(size, V3f(0.5F, 0.8F, 0.3F))] = Rgb(100, 100, 100);
  return map;
}

CubeMap two_area_lights(int size) {
  const float least_cosine = std::cos(0.28F);
  const V3f red = V3f(0.6F, 0.7F, 0.2F).normalized();
  const V3f green = V3f(-0.6F, 0.6F, 0.4F).normalized();
  CubeMap map{size, {}};
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const V3f w = cube_texel_direction(size, face, row, column);
        const bool is_red = w.dot(red) > least_cosine;
        const bool is_green = w.dot(green) > least_cosine;
        map.texels.push_back(is_red ? Rgb(1, 0.1F, 0.1F) : is_green ? Rgb(0.1F, 1, 0.1F) : Rgb(0, 0, 0));
      }
    }
  }
  return map;
}

FivBakeTime compare_with_rays(const FivOccluder& occluder, const CubeMap& environment, FivParams params,
                              std::size_t stride) {
  params.fit = false;
  params.fill_inside = false;
  FivBakeTime out;
  double start = now_s();
  const FivTable table = bake_fiv(occluder, environment, params);
  out.table_s = now_s() - start;

  const Intersector object(occluder.scene);
  const FivDirections directions = make_fiv_directions(environment, params.environment_size, params.parts);
  const std::vector<V3f> positions = fiv_sample_positions(table.size, table.radii);
  std::vector<V3f> some;
  for (std::size_t i = 0; i < positions.size(); i += stride) some.push_back(positions[i]);
  start = now_s();
  const FivSums sums = gather_fiv_by_rays(object, directions, some, table.hemispheres);
  out.rays_s = (now_s() - start) * double(positions.size()) / double(some.size());

  const auto numbers = std::size_t(3 * fiv_function_count(table.hemispheres));
  double squares = 0;
  double largest = 0;
  for (std::size_t i = 0; i < some.size(); ++i) {
    for (std::size_t j = 0; j < numbers; ++j) {
      const double value = double(sums.values[i * numbers + j]);
      const double difference = value - double(table.values[i * stride * numbers + j]);
      squares += difference * difference;
      largest = std::max(largest, std::abs(value));
    }
  }
  out.rms_difference = std::sqrt(squares / double(some.size() * numbers)) / largest;
  return out;
}

FivReadTime time_reading(const FivOccluder& occluder, const FivTable& table, const FivPlane& plane) {
  constexpr int rounds = 20;
  const Intersector object(occluder.scene);
  const std::vector<V3f> receivers = plane_receivers(plane);
  const std::vector<FivPlacement> one = placements(table, {V3f(0, 0, 0)});
  const double count = rounds * double(receivers.size());
  FivReadTime out;
  // What both compute is summed up, so that neither is optimised away.
  double sum = 0;
  double start = now_s();
  for (int round = 0; round < rounds; ++round) {
    for (const V3f& p : receivers) sum += double(fiv_irradiance(one, p, plane.n, -1, Rgb(1, 1, 1), {}).x);
  }
  out.table_ns = (now_s() - start) * 1e9 / count;
  start = now_s();
  for (int round = 0; round < rounds; ++round) {
    // Directions all over the upper hemisphere, as light would be sampled.
    for (std::size_t i = 0; i < receivers.size(); ++i) {
      const float phi = 2.39996323F * float(i);
      const float z = (float(i % 97) + 0.5F) / 97;
      const float s = std::sqrt(1 - z * z);
      Ray ray;
      ray.origin = receivers[i];
      ray.direction = {s * std::cos(phi), z, s * std::sin(phi)};
      sum += double(object.transmittance(ray));
    }
  }
  out.ray_ns = (now_s() - start) * 1e9 / count;
  if (!std::isfinite(sum)) out.ray_ns = 0;
  return out;
}

}  // namespace ivory
