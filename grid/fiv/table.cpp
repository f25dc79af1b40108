#include "grid/fiv/table.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "grid/base/circle.h"

namespace ivory {

namespace {

// The two neighbours along an axis and how far the second counts.
struct Between {
  std::size_t low = 0;
  std::size_t high = 0;
  float t = 0;
};

Between between_azimuths(const V3f& q, int count) {
  // Of a receiver on the polar axis atan2 gives any value; there all azimuths hold the same.
  const float u = 0.5F + std::atan2(-q.x, q.z) / (2 * pi);
  const float position = u * float(count);
  const int low = std::clamp(int(position), 0, count - 1);
  return {std::size_t(low), std::size_t((low + 1) % count), std::clamp(position - float(low), 0.0F, 1.0F)};
}

Between between_polars(const V3f& q, int count) {
  // atan2, as acos has no digits left near the poles.
  const float v = std::atan2(std::sqrt(q.x * q.x + q.z * q.z), q.y) / pi;
  const float position = v * float(count - 1);
  const int low = std::clamp(int(position), 0, count - 2);
  return {std::size_t(low), std::size_t(low + 1), std::clamp(position - float(low), 0.0F, 1.0F)};
}

Between between_radii(const std::vector<float>& radii, float r) {
  const auto above = std::upper_bound(radii.begin(), radii.end(), r);
  if (above == radii.begin()) return {0, 0, 0};
  const auto high = std::size_t(above - radii.begin());
  if (high == radii.size()) return {high - 1, high - 1, 0};
  // Even in the logarithm of distance, as a shadow's detail is.
  return {high - 1, high, std::log(r / radii[high - 1]) / std::log(radii[high] / radii[high - 1])};
}

Rgb dot(const float* vector, const V3f& n) {
  Rgb sum(0, 0, 0);
  for (unsigned axis = 0; axis < 3; ++axis) {
    for (unsigned c = 0; c < 3; ++c) sum[c] += vector[3 * axis + c] * n[axis];
  }
  return sum;
}

Rgb positive(const Rgb& c) { return {std::max(c.x, 0.0F), std::max(c.y, 0.0F), std::max(c.z, 0.0F)}; }

}  // namespace

FivTable first_hemisphere(const FivTable& six) {
  assert(six.hemispheres == 6);
  FivTable one = six;
  one.hemispheres = 1;
  one.values.clear();
  for (std::size_t i = 0; i < fiv_sample_count(six); ++i) {
    one.values.insert(one.values.end(), six.values.begin() + std::ptrdiff_t(36 * i),
                      six.values.begin() + std::ptrdiff_t(36 * i + 9));
  }
  return one;
}

V3d fiv_sample_direction(const V3i& size, int azimuth, int polar) {
  const Imath::V2d around = on_unit_circle(double(azimuth) / size.x);
  const Imath::V2d down = on_unit_circle(0.5 * polar / (size.y - 1));
  return {down.y * around.y, down.x, -down.y * around.x};
}

FivMoments lookup(const FivTable& table, const V3f& q) {
  assert(table.size.x >= 3 && table.size.y >= 2 && table.radii.size() == std::size_t(table.size.z));
  const float r = q.length();
  const Between azimuth = between_azimuths(q, table.size.x);
  const Between polar = between_polars(q, table.size.y);
  const Between distance = between_radii(table.radii, r);
  const auto numbers = std::size_t(3 * fiv_function_count(table.hemispheres));
  const float falloff = fiv_falloff(r);

  FivMoments out{};
  for (int corner = 0; corner < 8; ++corner) {
    const bool a = (corner & 1) != 0;
    const bool p = (corner & 2) != 0;
    const bool d = (corner & 4) != 0;
    const std::size_t k = d ? distance.high : distance.low;
    const float weight = (a ? azimuth.t : 1 - azimuth.t) * (p ? polar.t : 1 - polar.t) *
                         (d ? distance.t : 1 - distance.t) * falloff / fiv_falloff(table.radii[k]);
    if (weight == 0) continue;
    const std::size_t sample =
        (k * std::size_t(table.size.y) + (p ? polar.high : polar.low)) * std::size_t(table.size.x) +
        (a ? azimuth.high : azimuth.low);
    const float* values = table.values.data() + sample * numbers;
    for (std::size_t i = 0; i < numbers; ++i) out[i] += weight * values[i];
  }
  return out;
}

Rgb hidden_irradiance(const FivTable& table, const FivMoments& hidden, const V3f& n, float d, Straddling straddling) {
  if (d <= -1) return {0, 0, 0};
  const Rgb whole = positive(dot(hidden.data(), n));
  if (d >= 1) return whole;
  if (straddling == Straddling::scale) return whole * ((d + 1) / 2);
  if (table.hemispheres == 1) return whole;
  return irradiance_bracket(hidden.data(), n).lower;
}

Rgb self_shadowed_irradiance(const FivTable& table, const FivMoments& hidden, const V3f& n) {
  if (table.hemispheres == 1) return positive(dot(table.total.data(), n) - dot(hidden.data(), n));
  FivMoments visible;
  for (std::size_t i = 0; i < visible.size(); ++i) visible[i] = table.total[i] - hidden[i];
  return irradiance_bracket(visible.data(), n).lower;
}

}  // namespace ivory
