// Captures what arrives at a point: radiance and distance over a cube map.
#pragma once

#include <functional>

#include "grid/cubemap/captured.h"
#include "tracer/render/final_gather.h"

namespace ivory {

struct CaptureParams {
  int size = 256;   // texels along an edge of a face
  int samples = 8;  // of radiance a texel
  std::uint64_t seed = 1;
  int threads = 0;                       // 0: as many as TBB gives
  std::function<void(double)> progress;  // called now and then, from any thread, with the fraction done
  const GridLight* grid = nullptr;       // indirect light is read from it; path-traced where null
};

struct Capture {
  CapturedCube cube;
  // Shares of all directions, by solid angle: that meet nothing, and that meet a single-sided surface's back
  // first, as nearly all do from inside of a solid.
  double sky_share = 0;
  double back_share = 0;
};

// All light that arrives at `origin`, a point of the scene, in nits: emitted, reflected, the environment's. Punctual
// lights have no surface to be seen by; only what they light is seen. Back faces are not culled as for the eye. Does
// not depend on threads. Throws Error where the map does not fit into memory.
Capture capture_cube(const LitScene& lit, const V3f& origin, const CaptureParams& params);

}  // namespace ivory
