// Irradiance at points, path-traced: the truth that baked assets are judged by.
#pragma once

#include <functional>
#include <vector>

#include "tracer/core/surface.h"
#include "tracer/render/direct_light.h"

namespace ivory {

struct ProbePoint {
  V3f p;
  V3f n;  // unit
};

struct ProbeParams {
  int samples = 1024;      // a point
  int max_bounces = 1000;  // surfaces that light may scatter at on its way to the point
  std::uint64_t seed = 1;
  int threads = 0;  // 0: as many as TBB gives
  bool indirect_only = false;
  DirectStrategy strategy = DirectStrategy::mis;
  std::function<void(double)> progress;  // called now and then, from any thread, with the fraction done
};

struct ProbeResult {
  Rgb e;               // irradiance in lux
  Rgb standard_error;  // of e, lux
};

// A white Lambertian surface at p with the unit normal n: it scatters L = E/pi, so that E is pi times what a path from
// it brings. It adds one bounce of its own. p may lie on a surface, whose bulges rays are to start above.
Surface white_receiver(const LitScene& lit, const V3f& p, const V3f& n);

// E(p, n), including light that comes straight from its source unless indirect_only. A point may lie on a
// surface: rays start a little above it, on the side of n. Samples are independent, so that the
// standard error holds; results do not depend on threads.
std::vector<ProbeResult> probe_scene(const LitScene& lit, const std::vector<ProbePoint>& points,
                                     const ProbeParams& params);

}  // namespace ivory
