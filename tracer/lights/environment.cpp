#include "tracer/lights/environment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "grid/base/circle.h"
#include "grid/env/latlong_map.h"
#include "tracer/core/sampling.h"

namespace ivory {

namespace {

// A texel between polar angles theta0 and theta1 covers (2 pi / width) (cos theta0 - cos theta1).
double texel_solid_angle(const EnvironmentMap& map, int row) {
  // Half a row, in turns.
  const double half = 0.25 / map.height;
  // cos a - cos b = 2 sin((a+b)/2) sin((b-a)/2) keeps its digits near the poles.
  return 2 * std::numbers::pi / map.width * 2 * on_unit_circle((2 * row + 1) * half).y * on_unit_circle(half).y;
}

// A point of a texel, evenly by solid angle.
V3f direction_in(const EnvironmentMap& map, int row, int column, double u, double v) {
  const double top = on_unit_circle(0.5 * row / map.height).x;
  const double bottom = on_unit_circle(0.5 * (row + 1) / map.height).x;
  const double y = top + (bottom - top) * u;
  const double s = std::sqrt(std::max(0.0, (1 - y) * (1 + y)));
  const Imath::V2d around = on_unit_circle((column + v) / map.width - 0.5) * s;  // at atan2(-x, z)
  return {float(-around.y), float(y), float(around.x)};
}

// Texels are chosen by luminance times solid angle and directions uniformly within a texel, so the
// density is luminance / integral of luminance, whichever texel the direction lies in.
V3f sample_direction(const EnvironmentLight& light, RandomStream& random) {
  const EnvironmentMap& map = *light.map;
  const std::uint32_t texel = light.texels.sample(random);
  const V2f u = random.next2();
  return direction_in(map, int(texel / std::uint32_t(map.width)), int(texel % std::uint32_t(map.width)), double(u.x),
                      double(u.y));
}

// Where u of the last of ascending sums falls, and how far into the step there, 0 to 1.
struct Inverse {
  std::size_t index;
  double rest;
};
Inverse invert(std::span<const double> before, double u) {
  const double at = u * before.back();
  const auto next = std::upper_bound(before.begin(), before.end() - 1, at);
  const auto index = std::size_t(std::max<std::ptrdiff_t>(1, next - before.begin()) - 1);
  const double width = before[index + 1] - before[index];
  return {index, width > 0 ? std::clamp((at - before[index]) / width, 0.0, 1.0) : 0.5};
}

}  // namespace

EnvironmentLight make_environment_light(const EnvironmentMap& map) {
  EnvironmentLight light;
  light.map = &map;
  std::vector<double> weights(map.radiance.size());
  double integral[3] = {0, 0, 0};
  light.before_row.push_back(0);
  light.before_texel.reserve(weights.size());
  for (int row = 0; row < map.height; ++row) {
    const double solid_angle = texel_solid_angle(map, row);
    double in_row = 0;
    for (int column = 0; column < map.width; ++column) {
      const std::size_t i = std::size_t(row) * std::size_t(map.width) + std::size_t(column);
      const Rgb& radiance = map.radiance[i];
      weights[i] = double(luminance(radiance)) * solid_angle;
      in_row += weights[i];
      for (int c = 0; c < 3; ++c) integral[c] += double(radiance[c]) * solid_angle;
    }
    light.before_row.push_back(light.before_row.back() + in_row);
    double before = 0;
    for (int column = 0; column < map.width; ++column) {
      const double share = in_row > 0 ? before / in_row : 0;
      light.before_texel.push_back(std::uint32_t(std::min(share * 0x1p32, 0x1p32 - 1)));
      before += weights[std::size_t(row) * std::size_t(map.width) + std::size_t(column)];
    }
  }
  light.texels = AliasTable(weights);
  light.luminance_integral = light.texels.total();
  light.radiance_integral = Rgb(float(integral[0]), float(integral[1]), float(integral[2]));
  return light;
}

Rgb power_lm(const EnvironmentLight& light, float entry_area_m2) { return light.radiance_integral * entry_area_m2; }

SkyTable make_sky_table(const EnvironmentLight& light) {
  const EnvironmentMap& map = *light.map;
  SkyTable table;
  table.rows.push_back(0);
  for (int row = 0; row < map.height; ++row) {
    const double solid_angle = texel_solid_angle(map, row);
    double sum = 0;
    table.texels.push_back(0);
    for (int column = 0; column < map.width; ++column) {
      sum += double(luminance(map.radiance[std::size_t(row) * std::size_t(map.width) + std::size_t(column)]));
      table.texels.push_back(sum);
    }
    table.rows.push_back(table.rows.back() + sum * solid_angle);
  }
  return table;
}

EmittedPhoton emit(const EnvironmentLight& light, const SkyTable& table, const Imath::V2d& u, const EntryDiscs& discs,
                   std::size_t disc, const Imath::V2d& point) {
  const Inverse row = invert(table.rows, u.x);
  const auto width = std::size_t(light.map->width) + 1;
  const Inverse column = invert(std::span(table.texels).subspan(row.index * width, width), u.y);
  const V3f w = direction_in(*light.map, int(row.index), int(column.index), row.rest, column.rest);
  const Entry entry = enter(discs, disc, point, w, make_shading_frame(w));
  const float pdf = pdf_solid_angle(light, w);
  const Rgb power = pdf > 0 ? eval(*light.map, w) * (entry.area_m2 / pdf) : Rgb(0, 0, 0);
  return {entry.origin, -w, power};
}

// A direction of density p(w) and a point of the discs that face it, which stands for the area A, carry L A / p(w): the
// same luminance for every photon through one disc.
EmittedPhoton emit(const EnvironmentLight& light, const EntryDiscs& discs, RandomStream& random) {
  const V3f w = sample_direction(light, random);
  const Entry entry = sample(discs, w, make_shading_frame(w), random);
  const float pdf = pdf_solid_angle(light, w);
  const Rgb power = pdf > 0 ? eval(*light.map, w) * (entry.area_m2 / pdf) : Rgb(0, 0, 0);
  return {entry.origin, -w, power};
}

namespace {

std::optional<LightSample> sample_at(const EnvironmentLight& light, const V3f& w) {
  // Asked again for the direction as rounded: at a texel's edge it may belong to the neighbour, and
  // evaluation and pdf must then agree about that.
  const float pdf = pdf_solid_angle(light, w);
  if (!(pdf > 0)) return std::nullopt;
  return LightSample{w, std::numeric_limits<float>::infinity(), eval(*light.map, w) / pdf, pdf, false};
}

}  // namespace

std::optional<LightSample> sample(const EnvironmentLight& light, RandomStream& random) {
  return sample_at(light, sample_direction(light, random));
}

std::optional<LightSample> sample(const EnvironmentLight& light, const Imath::V2d& u) {
  if (light.texels.empty()) return std::nullopt;
  const Inverse row = invert(light.before_row, u.x);
  const std::size_t width = std::size_t(light.map->width);
  const std::span<const std::uint32_t> before = std::span(light.before_texel).subspan(row.index * width, width);
  const double at = u.y * 0x1p32;
  const auto next = std::upper_bound(before.begin() + 1, before.end(), at,
                                     [](double value, std::uint32_t entry) { return value < double(entry); });
  const double left = double(*(next - 1));
  const double right = next == before.end() ? 0x1p32 : double(*next);
  const double rest = std::clamp((at - left) / (right - left), 0.0, 1.0);
  return sample_at(light, direction_in(*light.map, int(row.index), int(next - 1 - before.begin()), row.rest, rest));
}

float pdf_solid_angle(const EnvironmentLight& light, const V3f& w) {
  if (light.texels.empty()) return 0;
  return float(double(luminance(eval(*light.map, w))) / light.luminance_integral);
}

}  // namespace ivory
