#include <algorithm>
#include <cmath>

#include "tracer/bake/fiv/baker.h"
#include "tracer/bake/fiv/directions.h"
#include "tracer/bake/fiv/gather.h"
#include "tracer/bake/fiv/inside.h"

namespace ivory {

namespace {

constexpr V3i::BaseType pilot_azimuths = 32;
constexpr V3i::BaseType pilot_polars = 17;
constexpr int pilot_spheres = 96;
constexpr int pilot_environment = 16;
constexpr int pilot_pixels = 64;
// Surfaces have more receivers farther out, in proportion to the square of distance, as far as shadows matter.
constexpr float reach = 2;
// The first sphere lies outside the mesh for at least this share of its area.
constexpr double least_outside = 0.2;
constexpr float nearest = 0.05F;
// Share of the spheres that stand evenly whatever was measured: what the pilot did not see.
constexpr double even_share = 0.15;

}  // namespace

std::vector<std::vector<float>> fiv_radii(const FivOccluder& occluder, const CubeMap& environment,
                                          const FivParams& params, std::span<const int> counts) {
  const Intersector object(occluder.scene, params.intersector);
  const FivDirections directions = make_fiv_pilot_directions(environment, pilot_environment);
  std::vector<float> pilot;
  const double step = std::log(double(params.farthest) / double(nearest)) / (pilot_spheres - 1);
  pilot.reserve(pilot_spheres);
  for (int k = 0; k < pilot_spheres; ++k) pilot.push_back(float(double(nearest) * std::exp(step * k)));
  const V3i size(pilot_azimuths, pilot_polars, pilot_spheres);
  const std::vector<V3f> positions = fiv_sample_positions(size, pilot);
  const FivSums sums = gather_fiv(object, directions, positions, 1, pilot_pixels, {});

  // A hat's error over an interval h is h^2 f''/8: with a density of spheres like the root of f'' all intervals
  // have the same. f is what interpolation works on, the sum over the falloff; its error counts with the falloff.
  const std::size_t shell = std::size_t(pilot_azimuths) * std::size_t(pilot_polars);
  std::vector<double> hidden;
  for (const std::uint32_t count : sums.hidden) hidden.push_back(double(count) / double(directions.w.size()));
  const std::vector<char> inside = find_inside(object, positions, hidden);
  const auto is_inside = [&](int k, std::size_t i) { return inside[std::size_t(k) * shell + i] != 0; };
  std::vector<double> density(pilot_spheres, 0);
  int first = pilot_spheres - 3;  // the first sphere that a receiver can stand on
  for (int k = pilot_spheres - 2; k >= 1; --k) {
    double squares = 0;
    double outside = 0;
    double whole = 0;
    for (std::size_t i = 0; i < shell; ++i) {
      const std::size_t polar = i / pilot_azimuths;
      const double area = std::sin(double(pi) * double(polar) / (pilot_polars - 1));
      whole += area;
      if (is_inside(k - 1, i) || is_inside(k, i) || is_inside(k + 1, i)) continue;
      outside += area;
      for (std::size_t c = 0; c < 9; ++c) {
        const auto f = [&](int sphere) {
          return double(sums.values[(std::size_t(sphere) * shell + i) * 9 + c] /
                        fiv_falloff(pilot[std::size_t(sphere)]));
        };
        const double second = f(k - 1) - 2 * f(k) + f(k + 1);
        squares += area * second * second;
      }
    }
    if (outside > least_outside * whole) first = k - 1;
    const double r = double(pilot[std::size_t(k)]);
    const double receivers = std::min(r, double(reach));
    density[std::size_t(k)] = std::sqrt(std::sqrt(squares) * double(fiv_falloff(float(r))) * receivers);
  }
  density.front() = density[1];
  density.back() = density[pilot_spheres - 2];

  double mean = 0;
  for (int k = first; k < pilot_spheres; ++k) mean += density[std::size_t(k)] / (pilot_spheres - first);
  std::vector<double> until(pilot_spheres, 0);  // spheres due up to here, as a share
  for (int k = first + 1; k < pilot_spheres; ++k) {
    const double here = 0.5 * (density[std::size_t(k)] + density[std::size_t(k - 1)]);
    until[std::size_t(k)] = until[std::size_t(k - 1)] + (mean > 0 ? (1 - even_share) * here / mean : 0) +
                            even_share * std::min(1.0, double(pilot[std::size_t(k)]));
  }
  std::vector<std::vector<float>> lists;
  for (const int count : counts) {
    std::vector<float> radii;
    for (int j = 0; j < count; ++j) {
      const double target = until.back() * j / (count - 1);
      const auto above = std::lower_bound(until.begin() + first + 1, until.end() - 1, target) - until.begin();
      const auto high = std::size_t(above);
      const double t = (target - until[high - 1]) / (until[high] - until[high - 1]);
      radii.push_back(float(double(pilot[high - 1]) * std::exp(step * t)));
    }
    radii.back() = params.farthest;
    lists.push_back(std::move(radii));
  }
  return lists;
}

}  // namespace ivory
