// A picture while it is rendered: sums over the samples of each pixel, and how many they are.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tracer/core/film.h"

namespace ivory {

// What the first surface along an eye ray is, beside its light.
struct FirstHit {
  Rgb albedo{1, 1, 1};  // diffuse and specular reflectance; 1 where nothing is hit or it shines by itself
  V3f normal{0, 0, 0};  // unit shading normal, world, towards the eye; 0 where nothing is hit
  float depth_m = 0;    // along the camera's axis
  float emits = 0;      // 1 where it shines by itself, else 0
  float hit = 0;        // 1, or 0 where nothing is: depth_m does not count then
};

// Sums of a half are what its samples add up to: one number of each channel a pixel, float, rounded each time that a
// pixel was visited. The same visits give the same bits.
struct FilmSums {
  static constexpr int radiance_channels = 3;
  static constexpr int channels_with_features = 12;  // radiance, albedo, normal, depth, hit, emits

  int width = 0;
  int height = 0;
  int halves = 1;  // 2: two sets of samples, as many in each, whose random numbers have nothing to do with each other
  int channels = radiance_channels;
  int rounds = 0;                            // that were begun
  double seconds = 0;                        // wall time that went into it
  std::vector<std::uint32_t> samples;        // [pixel] in each half
  std::vector<std::uint32_t> goal;           // [pixel] what the round under way wants there
  std::array<std::vector<float>, 2> sums{};  // [half][pixel * channels + channel]

  std::size_t pixel_count() const { return samples.size(); }
  bool has_features() const { return channels == channels_with_features; }
  // Means over a half's samples; black without any.
  Rgb radiance(int half, std::size_t pixel) const { return mean(half, pixel, 0); }
  FirstHit first_hit(int half, std::size_t pixel) const;  // the normal is a mean, and depth one over what is hit
  // Over both halves.
  Rgb radiance(std::size_t pixel) const {
    return halves == 1 ? radiance(0, pixel) : (radiance(0, pixel) + radiance(1, pixel)) * 0.5F;
  }
  FirstHit first_hit(std::size_t pixel) const;

 private:
  Rgb mean(int half, std::size_t pixel, int first_channel) const;
};

// All zero. Throws Error where it does not fit into memory.
FilmSums make_film_sums(int width, int height, int halves, bool features);

// The picture so far.
Film make_film(const FilmSums& sums);

}  // namespace ivory
