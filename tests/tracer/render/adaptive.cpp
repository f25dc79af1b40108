// Pictures to a measured error: is the error that is stated the true one, do samples go where the noise is, what is a
// picture off by that decides on its own samples; and pauses.
#include "tracer/render/adaptive.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/support/lit_scene.h"

namespace ivory {
namespace {

constexpr int width = 64;
constexpr int height = 48;

// Rays start at their own places: x is the pixel's column.
View flat_view() {
  View view;
  view.perspective = false;
  view.origin = V3f(width / 2.0F, height / 2.0F, 0);
  view.right = V3f(width / 2.0F, 0, 0);
  view.up = V3f(0, height / 2.0F, 0);
  view.forward = V3f(0, 0, -1);
  view.width = width;
  view.height = height;
  return view;
}

// Quarters from left to right: black; 0.5 without noise; 1 with the noise of an exponential; 1 as one sample in 40 that
// has 40.
enum class Quarter { black, still, smooth, rare };
Quarter quarter_of(int x) { return Quarter(4 * x / width); }
double truth_at(int x) {
  const Quarter q = quarter_of(x);
  return q == Quarter::black ? 0 : q == Quarter::still ? 0.5 : 1;
}
Rgb noisy(const Ray& ray, RandomStream& random) {
  const Quarter q = quarter_of(std::clamp(int(ray.origin.x), 0, width - 1));
  for (int i = 0; i < 5; ++i) random.next();  // those that are spread evenly
  const float u = random.next();
  const float value = q == Quarter::black    ? 0.0F
                      : q == Quarter::still  ? 0.5F
                      : q == Quarter::smooth ? -std::log(1 - u)
                      : u < 1.0F / 40        ? 40.0F
                                             : 0.0F;
  return Rgb(value, value, value);
}

RenderParams to_error(double target, std::uint64_t seed = 1) {
  RenderParams params;
  params.seed = seed;
  params.adaptive.emplace();
  params.adaptive->target = target;
  return params;
}

double true_error(const Film& film) {
  double squares = 0;
  double mean = 0;
  for (int y = 0; y < film.height; ++y) {
    for (int x = 0; x < film.width; ++x) {
      const double off = double(luminance(film.at(x, y))) - truth_at(x);
      squares += off * off;
      mean += truth_at(x);
    }
  }
  return std::sqrt(squares * double(film.pixels.size())) / mean;
}

// Each picture's within 0.8 to 1.25. Over 12 pictures, of 768 rare pixels each whose squared errors scatter by their
// own size and half as much again, mean squares are known to 2 %, their roots' ratio to about that: 5 % is 2.5 of it.
// If a pixel's own halves decide how many samples it gets, the ratio is 0.90.
TEST(Adaptive, TheStatedErrorIsTheTrueOne) {
  double stated = 0;
  double found = 0;
  double block = 0;
  constexpr int pictures = 12;
  for (std::uint64_t seed = 1; seed <= pictures; ++seed) {
    const Film film = render_film(flat_view(), to_error(0.25, seed), noisy);
    ASSERT_TRUE(film.noise);
    EXPECT_LE(film.noise->error.pixel, 0.25);
    EXPECT_GT(film.noise->error.pixel, 0.15);  // it does not overshoot by twice the samples
    const double truth = true_error(film);
    EXPECT_GT(film.noise->error.pixel / truth, 0.8) << seed;
    EXPECT_LT(film.noise->error.pixel / truth, 1.25) << seed;
    stated += film.noise->error.pixel * film.noise->error.pixel;
    block += film.noise->error.block * film.noise->error.block;
    found += truth * truth;
  }
  EXPECT_NEAR(std::sqrt(stated / found), 1, 0.05);
  // Pixels' noise is independent, so that means over 64 have an eighth. 12 x 12 blocks of the rare quarter tell a mean
  // square to 12 %, its root to 6 %: three of that.
  EXPECT_NEAR(std::sqrt(block / stated), 0.125, 0.125 * 0.18);
}

// What is left of the bias of stopping by what was seen. 40 pictures know the mean of the rare quarter to 0.3 %, of the
// smooth one to 0.1 %. If a pixel's own halves have a say, they are off by -0.7 and -0.2 %.
TEST(Adaptive, RareLightIsNotLost) {
  Accumulator rare;
  Accumulator smooth;
  for (std::uint64_t seed = 100; seed < 140; ++seed) {
    const Film film = render_film(flat_view(), to_error(0.3, seed), noisy);
    double mean[2] = {0, 0};
    for (int y = 0; y < height; ++y) {
      for (int x = width / 2; x < width; ++x)
        mean[quarter_of(x) == Quarter::rare ? 1 : 0] += double(film.at(x, y).y) / (height * width / 4);
    }
    smooth.add(mean[0]);
    rare.add(mean[1]);
  }
  EXPECT_LT(std::abs(z_score(smooth, 1)), z_limit) << smooth.mean();
  EXPECT_LT(std::abs(z_score(rare, 1)), z_limit) << rare.mean();
  EXPECT_LT(smooth.standard_error(), 0.001);
  EXPECT_LT(rare.standard_error(), 0.004);
}

TEST(Adaptive, SamplesGoWhereTheNoiseIs) {
  const Film film = render_film(flat_view(), to_error(0.15), noisy);
  double samples[4] = {0, 0, 0, 0};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      samples[int(quarter_of(x))] += 2.0 * film.sums->samples[std::size_t(y * width + x)] / (height * width / 4);
  }
  // Standard deviations 0, 0, 1 and sqrt(39): in proportion, but a quarter of the mean one at least. The mean one is
  // (1 + 6.2 + 2 x 0.45) / 4 of the quarters with their floors; smeared where quarters meet.
  EXPECT_NEAR(samples[0] / samples[3], 0.25 * (1 + std::sqrt(39.0)) / 4 / std::sqrt(39.0), 0.015);
  EXPECT_NEAR(samples[2] / samples[3], 1 / std::sqrt(39.0), 0.06);
}

TEST(Adaptive, WithoutNoiseTheFirstRoundIsTheLast) {
  const LitScene lit = make_lit_scene(furnace(0.5F, Rgb(1, 1, 1)));
  const Film film = render_path(lit, test_view(16, 12), to_error(0.01), {.max_bounces = 0});
  EXPECT_EQ(film.noise->error.pixel, 0);
  EXPECT_EQ(film.noise->most_samples, least_samples);
  EXPECT_EQ(film.noise->rounds, 1);
  const Film black = render_path(make_lit_scene(furnace(0.5F, Rgb(0, 0, 0))), test_view(16, 12), to_error(0.01), {});
  EXPECT_EQ(black.noise->error.pixel, 0);
}

TEST(Adaptive, BoundsHold) {
  RenderParams params = to_error(1e-4);
  params.adaptive->max_samples = 40;
  const Film film = render_film(flat_view(), params, noisy);
  EXPECT_LE(film.noise->most_samples, 40);
  EXPECT_GT(film.noise->error.pixel, 1e-4);
  EXPECT_FALSE(film.noise->out_of_time);
  // By the clock: with a target that none reaches, and with none. The first round is always whole.
  for (const double target : {1e-6, 0.0}) {
    params = to_error(target);
    params.adaptive->max_seconds = 0.05;
    const Film timed = render_film(flat_view(), params, noisy);
    EXPECT_TRUE(timed.noise->out_of_time);
    EXPECT_GE(timed.noise->least_samples, least_samples);
    EXPECT_LT(timed.render_seconds, 2);
  }
}

// Whatever threads and pauses there are, and where it is gone on from: to a number of samples, and to an error.
TEST(Adaptive, PausesLeaveNoTrace) {
  const LitScene lit = make_lit_scene(small_room());
  const View view = test_view(40, 30);
  RenderParams to_number;
  to_number.samples = 100;
  for (RenderParams params : {to_number, to_error(0.2)}) {
    params.threads = 1;
    params.first_hits_of = &lit;
    const Film whole = render_path(lit, view, params, {});
    struct Stopped : std::runtime_error {
      using std::runtime_error::runtime_error;
    };
    params.threads = 2;
    int wishes = 0;  // one thread at a time asks
    params.wants_pause = [&] { return ++wishes % 2 == 0 ? PauseWish::at_once : PauseWish::soon; };
    int pauses = 0;
    FilmSums kept;
    params.pause = [&](const FilmSums& sums) {
      kept = sums;
      if (++pauses % 3 == 0) throw Stopped("");
    };
    Film film;
    for (;;) {
      try {
        film = render_path(lit, view, params, {});
        break;
      } catch (const Stopped&) {
        params.begin_with = kept;
      }
    }
    EXPECT_GE(pauses, film.noise ? film.noise->rounds : 3);
    EXPECT_EQ(film.pixels, whole.pixels);
    EXPECT_EQ(film.sums->sums, whole.sums->sums);
  }
}

}  // namespace
}  // namespace ivory
