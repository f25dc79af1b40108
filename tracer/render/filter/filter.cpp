#include "tracer/render/filter/filter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tracer/render/filter/box_mean.h"
#include "tracer/render/filter/guided_means.h"

namespace ivory {

namespace {

using Halves = LightHalves;

constexpr int fade_radius = 2;   // of choices into each other
constexpr int error_radius = 6;  // over which e is averaged before it is believed, but for those
constexpr std::size_t none = candidates.size();
constexpr std::size_t choices = candidates.size() + 1;

Rgb square(const Rgb& c) { return c * c; }

// The same between error_radius and fade_radius: what is chosen by it, and fades into pixels as far as that, does not
// hang on their own light. The whole square where the picture is no larger.
std::vector<float> ring_mean(const std::vector<float>& values, int width, int height) {
  const auto length = [](int at, int count, int radius) {
    return std::min(count - 1, at + radius) - std::max(0, at - radius) + 1;
  };
  std::vector<float> outer = box_mean(values, width, height, error_radius);
  const std::vector<float> inner = box_mean(values, width, height, fade_radius);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
      const auto all = float(length(x, width, error_radius) * length(y, height, error_radius));
      const auto near = float(length(x, width, fade_radius) * length(y, height, fade_radius));
      if (all > near) outer[i] = (outer[i] * all - inner[i] * near) / (all - near);
    }
  }
  return outer;
}

// e of the file's head, of each channel.
Rgb squared_error(const Rgb& a, const Rgb& b, const Rgb& filtered_a, const Rgb& filtered_b) {
  return (square(filtered_a - b) + square(filtered_b - a) - square(a - b)) * 0.5F -
         square(filtered_a - filtered_b) * 0.25F;
}

struct MeanError {
  double error = 0;
  double high = 0;  // with two standard errors more
};

// Of luminance, ÷ the picture's mean. Scatter of blocks, taken as independent, tells how well the mean is known.
MeanError mean_error(const FilmSums& sums, const Halves& filtered) {
  constexpr int side = 16;
  const int columns = (sums.width + side - 1) / side;
  std::vector<double> blocks(std::size_t(columns) * std::size_t((sums.height + side - 1) / side), 0);
  double all = 0;
  double mean = 0;
  const auto count = double(sums.pixel_count());
  for (std::size_t i = 0; i < sums.pixel_count(); ++i) {
    const double a = double(luminance(sums.radiance(0, i)));
    const double b = double(luminance(sums.radiance(1, i)));
    const double fa = double(luminance(filtered[0][i]));
    const double fb = double(luminance(filtered[1][i]));
    const double e =
        0.5 * ((fa - b) * (fa - b) + (fb - a) * (fb - a) - (a - b) * (a - b)) - 0.25 * (fa - fb) * (fa - fb);
    const auto x = int(i % std::size_t(sums.width));
    const auto y = int(i / std::size_t(sums.width));
    blocks[std::size_t(y / side * columns + x / side)] += e / count;
    all += e / count;
    mean += 0.5 * (a + b) / count;
  }
  if (!(mean > 0)) return {};
  const double of_each = all / double(blocks.size());
  double scatter = 0;
  for (const double block : blocks) scatter += (block - of_each) * (block - of_each);
  return {std::sqrt(std::max(0.0, all)) / mean, std::sqrt(std::max(0.0, all + 2 * std::sqrt(scatter))) / mean};
}

}  // namespace

FilteredFilm filter_film(const FilmSums& sums, const FilterParams& params) {
  const std::size_t count = sums.pixel_count();
  const auto [filtered, shines] = guided_means(sums, params.radius, params.threads);
  Halves unfiltered;
  for (int half = 0; half < 2; ++half) {
    for (std::size_t i = 0; i < count; ++i) unfiltered[std::size_t(half)].push_back(sums.radiance(half, i));
  }
  std::vector<std::size_t> best(count, none);
  std::vector<float> least(count, 0);
  for (std::size_t n = 0; n < choices; ++n) {
    const std::size_t k = n == 0 ? none : n - 1;  // where none is better, none
    std::vector<float> error(count);
    for (std::size_t i = 0; i < count; ++i) {
      const Halves& light = k == none ? unfiltered : filtered[k];
      const Rgb e = squared_error(unfiltered[0][i], unfiltered[1][i], light[0][i], light[1][i]);
      error[i] = shines[i] ? 0 : e.x + e.y + e.z;
    }
    error = ring_mean(error, sums.width, sums.height);
    for (std::size_t i = 0; i < count; ++i) {
      if (shines[i] || (n != 0 && !(error[i] < least[i]))) continue;
      least[i] = error[i];
      best[i] = k;
    }
  }
  // Choices fade into each other.
  std::array<std::vector<float>, choices> share;
  for (std::size_t k = 0; k < choices; ++k) {
    share[k].resize(count);
    for (std::size_t i = 0; i < count; ++i) share[k][i] = best[i] == k ? 1.0F : 0.0F;
    share[k] = box_mean(share[k], sums.width, sums.height, fade_radius);
    for (std::size_t i = 0; i < count; ++i) {
      if (shines[i]) share[k][i] = k == none ? 1.0F : 0.0F;
    }
  }
  Halves chosen;
  FilteredFilm result;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t half = 0; half < 2; ++half) {
      Rgb light = unfiltered[half][i] * share[none][i];
      for (std::size_t k = 0; k < candidates.size(); ++k) light += filtered[k][half][i] * share[k][i];
      chosen[half].push_back(light);
    }
    result.filtered_share += double(1 - share[none][i]) / double(count);
  }
  result.film = make_film(sums);
  const MeanError before = mean_error(sums, unfiltered);
  const MeanError after = mean_error(sums, chosen);
  result.unfiltered_error = before.error;
  result.error = after.error;
  result.high = after.high;
  if (!(after.error < before.error)) {
    result.error = before.error;
    result.high = before.high;
    result.filtered_share = 0;
    return result;
  }
  for (std::size_t i = 0; i < count; ++i) result.film.pixels[i] = (chosen[0][i] + chosen[1][i]) * 0.5F;
  return result;
}

}  // namespace ivory
