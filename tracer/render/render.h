// What every rendering method shares: samples through pixels, threads, progress.
#pragma once

#include <functional>

#include "tracer/core/camera.h"
#include "tracer/core/film.h"
#include "tracer/core/sampler.h"

namespace ivory {

struct RenderParams {
  int samples = 64;  // a pixel
  std::uint64_t seed = 1;
  int threads = 0;                       // 0: as many as TBB gives
  std::function<void(double)> progress;  // called now and then, from any thread, with the fraction done
};

// One estimate of the radiance in nits along an eye ray.
using RadianceFunction = std::function<Rgb(const Ray&, RandomStream&)>;

// Averages `samples` estimates a pixel (box filter, low-discrepancy positions). A pixel's random numbers
// depend on the seed and the pixel alone, so the picture does not depend on threads.
// Throws Error where the picture does not fit into memory.
Film render_film(const View& view, const RenderParams& params, const RadianceFunction& radiance);

}  // namespace ivory
