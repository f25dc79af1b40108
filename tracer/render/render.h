// What every rendering method shares: samples through pixels, in rounds, by threads, to a number or to an error.
#pragma once

#include <functional>
#include <optional>

#include "tracer/core/camera.h"
#include "tracer/core/film.h"
#include "tracer/core/film_sums.h"
#include "tracer/core/lit_scene.h"
#include "tracer/core/sampler.h"
#include "tracer/render/adaptive.h"

namespace ivory {

enum class PauseWish {
  none,
  soon,    // when each thread has done the samples of a pixel that it is at
  at_once  // those are given up
};

struct RenderParams {
  int samples = 64;  // a pixel; `adaptive` has its own
  std::uint64_t seed = 1;
  int threads = 0;                       // 0: as many as TBB gives
  std::function<void(double)> progress;  // called now and then, from any thread, with the fraction done, or about it
  // Samples by the error that is measured, instead of as many for each pixel.
  std::optional<AdaptiveParams> adaptive = std::nullopt;
  // Two halves of independent samples, so that the noise is measured, also where `samples` are asked for: an odd number
  // becomes the next even one then. Always so with `adaptive`.
  bool halves = false;
  // The scene whose first hits are kept beside the light (FirstHit): one eye ray a sample more. Null: none are.
  const LitScene* first_hits_of = nullptr;

  // Of the same view and parameters: goes on from there, to the same bytes.
  std::optional<FilmSums> begin_with = std::nullopt;
  // Asked many times a second, from any thread, one at a time. Where it wishes so rendering pauses and `pause` is
  // called in the caller's thread; then it goes on. What `pause` throws ends it.
  std::function<PauseWish()> wants_pause = nullptr;
  std::function<void(const FilmSums&)> pause = nullptr;
};

// One estimate of the radiance in nits along an eye ray.
using RadianceFunction = std::function<Rgb(const Ray&, RandomStream&)>;

// Averages estimates over pixels (box filter, low-discrepancy positions). Rounds double the number of samples; what a
// round does is decided by what all rounds before found, and a pixel's random numbers depend on the seed, the pixel,
// the half and the sample alone. So the picture depends neither on threads nor on pauses, but for a bound on time.
// Throws Error where the picture does not fit into memory.
Film render_film(const View& view, const RenderParams& params, const RadianceFunction& radiance);

}  // namespace ivory
