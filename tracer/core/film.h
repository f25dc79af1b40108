// A picture of linear radiance.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "grid/base/types.h"

namespace ivory {

struct FilmSums;

// Noise ÷ mean luminance of the picture: the root of the mean over pixels of the squared standard error of a pixel's
// luminance, and the same of the means over blocks of 8x8 pixels. What every sample has in common (the bias of what is
// baked, for instance) is none of it.
struct NoiseError {
  double pixel = 0;
  double block = 0;
  double pixel_standard_error = 0;  // how well `pixel` is known: badly where few pixels have most of the noise
};

// How a picture came to its samples, where its noise was measured.
struct FilmNoise {
  NoiseError error;
  int least_samples = 0;  // a pixel
  double mean_samples = 0;
  int most_samples = 0;
  int rounds = 0;
  bool out_of_time = false;  // ended by the clock
};

struct Film {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;    // nits, top row first
  double render_seconds = 0;  // wall time of render_film(): rays and shading, without what they are prepared by
  std::optional<FilmNoise> noise = std::nullopt;
  std::shared_ptr<const FilmSums> sums = nullptr;  // where they have halves or first hits: what it is made of

  Rgb& at(int x, int y) { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
  const Rgb& at(int x, int y) const { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};

// Exposure in stops that brings the logarithmic mean of the lit pixels' luminance to middle grey (0.18), or, where that
// is less, their ninth decile to white (1): a dark background must not wash out what stands before it. 0 for a black
// film.
float auto_exposure(const Film& film);

// Linear light to display light (0 to 1, still linear): the Khronos PBR Neutral tone mapper, which
// leaves everything below 0.8 almost alone.
Rgb tone_map(const Rgb& linear);

}  // namespace ivory
