// The filter: what it gains and what it is off by, against long references; and where it must not be used.
#include "tracer/render/filter/filter.h"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/lit_scene.h"

namespace ivory {
namespace {

struct Off {
  double error = 0;  // RMS of luminance ÷ the mean
  double bias = 0;   // of the mean
};

Off off(const Film& film, const Film& truth) {
  double squares = 0;
  double difference = 0;
  double mean = 0;
  for (std::size_t i = 0; i < film.pixels.size(); ++i) {
    const double d = double(luminance(film.pixels[i])) - double(luminance(truth.pixels[i]));
    squares += d * d;
    difference += d;
    mean += double(luminance(truth.pixels[i]));
  }
  return {std::sqrt(squares * double(film.pixels.size())) / mean, difference / mean};
}

RenderParams with_sums(const LitScene& lit, int samples, std::uint64_t seed) {
  RenderParams params;
  params.samples = samples;
  params.seed = seed;
  params.halves = true;
  params.first_hits_of = &lit;
  return params;
}

// At 8 and at 32 samples 0.85 and 0.7 of the error at most (found: 0.77 and 0.63), the mean off by less than 1.5 %
// (found: 0.7 %); and the error that is stated is the true one, in the mean of four pictures to a quarter (found:
// 0.91), its upper bound passed by two of eight at most. The reference's noise is a third of what is found, 5 % of it.
TEST(Filter, GainsAndSaysWhatItIsOffBy) {
  const LitScene lit = make_lit_scene(small_room());
  const View view = test_view(48, 36);
  RenderParams long_params;
  long_params.samples = 2048;
  long_params.seed = 77;
  const Film truth = render_path(lit, view, long_params, {});
  int above = 0;
  for (const auto& [samples, most] : {std::pair{8, 0.85}, std::pair{32, 0.7}}) {
    double before = 0;
    double after = 0;
    double stated = 0;
    double bias = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const Film film = render_path(lit, view, with_sums(lit, samples, seed), {});
      const FilteredFilm filtered = filter_film(*film.sums, {});
      const Off noisy = off(film, truth);
      const Off found = off(filtered.film, truth);
      EXPECT_LT(found.error, noisy.error);
      EXPECT_GT(filtered.filtered_share, 0.9);
      before += noisy.error * noisy.error;
      after += found.error * found.error;
      stated += filtered.error * filtered.error;
      bias += (found.bias - noisy.bias) / 4;
      if (found.error > filtered.high) ++above;
    }
    EXPECT_LT(std::sqrt(after / before), most) << samples;
    EXPECT_NEAR(std::sqrt(stated / after), 1, 0.25) << samples;
    EXPECT_LT(std::abs(bias), 0.015) << samples;
  }
  EXPECT_LE(above, 2);
}

// Light that differs from pixel to pixel on a flat white wall, as first hits do not tell: averages would be wrong.
TEST(Filter, LeavesAloneWhatItWouldSpoil) {
  FilmSums sums = make_film_sums(64, 48, 2, true);
  RandomStream random(3, StreamPurpose::test, 0);
  Film truth{64, 48, {}};
  for (std::size_t i = 0; i < sums.pixel_count(); ++i) {
    sums.samples[i] = 4;
    const float light = random.next() < 0.5F ? 1.0F : 9.0F;
    truth.pixels.emplace_back(light, light, light);
    for (std::vector<float>* half : {&sums.sums[0], &sums.sums[1]}) {
      const float noisy = light + 1.5F * (random.next() + random.next() + random.next() - 1.5F);
      const float channels[12] = {noisy, noisy, noisy, 1, 1, 1, 0, 0, 1, 5, 1, 0};
      for (std::size_t c = 0; c < 12; ++c) (*half)[i * 12 + c] = 4 * channels[c];
    }
  }
  const FilteredFilm filtered = filter_film(sums, {});
  const double before = off(make_film(sums), truth).error;
  EXPECT_LT(off(filtered.film, truth).error, 1.02 * before);
  EXPECT_NEAR(filtered.unfiltered_error, before, 0.05 * before);
  // Without noise there is nothing to do, to the bit.
  sums.sums[1] = sums.sums[0];
  EXPECT_EQ(filter_film(sums, {}).film.pixels, make_film(sums).pixels);
  EXPECT_EQ(filter_film(sums, {}).filtered_share, 0);
}

TEST(Filter, GivesTheSameBitsOnAnyNumberOfThreads) {
  const LitScene lit = make_lit_scene(small_room());
  const Film film = render_path(lit, test_view(70, 45), with_sums(lit, 8, 1), {});
  EXPECT_EQ(filter_film(*film.sums, {.threads = 1}).film.pixels, filter_film(*film.sums, {.threads = 2}).film.pixels);
}

}  // namespace
}  // namespace ivory
