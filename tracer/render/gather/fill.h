// Fills an irradiance cache with what a picture needs.
#pragma once

#include <functional>

#include "tracer/core/camera.h"
#include "tracer/render/final_gather.h"

namespace ivory {

struct CacheParams {
  int rays = 300;       // a record, rounded to 75 times a square
  float error = 0.01F;  // as RecordLimits: smaller makes more records
  // Samples a pixel and gather rays a sample that the cache saves: records that cost more than a share of the rays that
  // they save are not made.
  int samples = 64;
  int gather_rays = 1;
  std::uint64_t seed = 1;
  int threads = 0;                       // 0: as many as TBB gives
  std::function<void(double)> progress;  // called now and then with the fraction of pixels looked at
};

struct FilledCache {
  IrradianceCache cache;
  std::int64_t rays = 0;  // traced for it
  double uncovered = 0;   // share of the pixels with a surface that it does not cover
};

// Records at the surfaces that the view's pixels see through their middles, each gathered as gather_light() by
// `gather`. Coarse pixels first, and in an order that does not depend on threads.
FilledCache fill_cache(const LitScene& lit, const IndirectLight& indirect, const View& view, const GatherParams& gather,
                       const CacheParams& params);

}  // namespace ivory
