#include "tracer/core/film_sums.h"

#include <string>

#include "grid/base/memory.h"

namespace ivory {

Rgb FilmSums::mean(int half, std::size_t pixel, int first_channel) const {
  if (samples[pixel] == 0) return Rgb(0, 0, 0);
  const float* sum = &sums[std::size_t(half)][pixel * std::size_t(channels) + std::size_t(first_channel)];
  const double scale = 1.0 / samples[pixel];
  return Rgb(float(double(sum[0]) * scale), float(double(sum[1]) * scale), float(double(sum[2]) * scale));
}

FirstHit FilmSums::first_hit(int half, std::size_t pixel) const {
  FirstHit first;
  if (!has_features() || samples[pixel] == 0) return first;
  first.albedo = mean(half, pixel, 3);
  first.normal = mean(half, pixel, 6);
  const float* rest = &sums[std::size_t(half)][pixel * std::size_t(channels) + 9];
  first.depth_m = rest[1] > 0 ? rest[0] / rest[1] : 0;
  first.hit = rest[1] / float(samples[pixel]);
  first.emits = rest[2] / float(samples[pixel]);
  return first;
}

FirstHit FilmSums::first_hit(std::size_t pixel) const {
  const FirstHit a = first_hit(0, pixel);
  if (halves == 1) return a;
  const FirstHit b = first_hit(1, pixel);
  FirstHit both;
  both.albedo = (a.albedo + b.albedo) * 0.5F;
  both.normal = (a.normal + b.normal) * 0.5F;
  both.hit = (a.hit + b.hit) * 0.5F;
  both.emits = (a.emits + b.emits) * 0.5F;
  both.depth_m = both.hit > 0 ? (a.depth_m * a.hit + b.depth_m * b.hit) / (a.hit + b.hit) : 0;
  return both;
}

FilmSums make_film_sums(int width, int height, int halves, bool features) {
  FilmSums sums;
  sums.width = width;
  sums.height = height;
  sums.halves = halves;
  sums.channels = features ? FilmSums::channels_with_features : FilmSums::radiance_channels;
  const std::size_t count = std::size_t(width) * std::size_t(height);
  // Sums, samples and goals; pixels, and their copy on the way to a file.
  check_memory("image of " + std::to_string(width) + "x" + std::to_string(height),
               double(count) * (halves * sums.channels * 4 + 8 + 24), "choose a smaller size");
  sums.samples.assign(count, 0);
  sums.goal.assign(count, 0);
  for (int half = 0; half < halves; ++half) sums.sums[std::size_t(half)].assign(count * std::size_t(sums.channels), 0);
  return sums;
}

Film make_film(const FilmSums& sums) {
  Film film;
  film.width = sums.width;
  film.height = sums.height;
  film.render_seconds = sums.seconds;
  film.pixels.reserve(sums.pixel_count());
  for (std::size_t i = 0; i < sums.pixel_count(); ++i) film.pixels.push_back(sums.radiance(i));
  return film;
}

}  // namespace ivory
