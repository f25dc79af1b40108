// Lightmaps: E per texel of a scene's charts, by final gather.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tracer/bake/lightmap/charts.h"
#include "tracer/render/final_gather.h"

namespace ivory {

struct LightmapParams {
  int samples = 16;      // a texel, spread over its square: direct light is sampled once at each
  int gather_rays = 32;  // a sample; 0 reads the stored light at the texel itself
  std::uint64_t seed = 1;
  bool indirect_only = false;
  int dilate = 8;  // texels that charts grow beyond their edges
  int threads = 0;
  std::function<void(double)> progress;  // called now and then, from any thread, with the fraction done
};

enum class TexelState : std::uint8_t {
  empty,    // no chart is near: black
  baked,    // E was gathered there
  buried,   // inside of a solid: has the mean of its neighbours
  dilated,  // beside a chart: likewise
};

struct Lightmap {
  int width = 0;
  int height = 0;
  std::vector<Rgb> e;              // lux, height x width, v = 0 first
  std::vector<TexelState> states;  // likewise

  std::size_t count(TexelState state) const;
};

// E of each texel's square at the smooth normal of its surface's front side. A texel from which most of the hemisphere
// shows the backs of single-sided surfaces is buried. The same for the same seed at any number of threads.
Lightmap bake_lightmap(const LitScene& lit, const IndirectLight& indirect, const Charts& charts,
                       const LightmapParams& params);

}  // namespace ivory
