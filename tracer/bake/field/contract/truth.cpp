#include "tracer/bake/field/contract/truth.h"

#include <algorithm>
#include <array>

#include "tracer/core/sampler.h"
#include "tracer/core/surface.h"
#include "tracer/render/path_tracer.h"

namespace ivory {
namespace {

// The calls for random numbers of a path that are drawn evenly: those of its first bounce and of the light sampled at
// its end.
constexpr std::uint32_t even_calls = 8;

// A white Lambertian surface scatters L = E/pi, and adds one bounce of its own (tracer/render/probe.cpp).
struct WhitePoint {
  Surface surface;
  PathParams path;
};

WhitePoint white_point(const LitScene& lit, const V3f& p, const V3f& n, const TruthParams& params) {
  WhitePoint white;
  white.surface.p = p;
  white.surface.ng = n;
  white.surface.ns = n;
  white.surface.diffuse_albedo = Rgb(1, 1, 1);
  white.surface.specular_f0 = Rgb(0, 0, 0);
  white.surface.specular_f90 = Rgb(0, 0, 0);
  white.surface.emission = Rgb(0, 0, 0);
  white.surface.reach_m = own_surface_reach_m(lit.intersector, p, n);
  white.path.max_bounces = params.max_bounces + 1;
  white.path.indirect_only = params.indirect_only;
  return white;
}

}  // namespace

Truth trace_truth(const LitScene& lit, const V3f& p, const V3f& n, int paths, std::uint64_t index,
                  const TruthParams& params) {
  const WhitePoint white = white_point(lit, p, n, params);
  RandomStream random(params.seed, StreamPurpose::truth, 2 * index);
  const int group_paths = (paths + truth_groups - 1) / truth_groups;
  std::array<V3d, truth_groups> means;
  Truth truth;
  for (V3d& mean : means) {
    const std::uint32_t key = random.next_u32();
    mean = V3d(0, 0, 0);
    for (int i = 0; i < group_paths; ++i) {
      random.begin_sample(std::uint32_t(i), key, even_calls);
      mean += V3d(trace_scattered(lit, white.surface, n, white.path, random) * pi);
    }
    // The next key is no point of a sequence.
    random.begin_sample(0, 0, 0);
    mean /= group_paths;
    truth.e += mean / truth_groups;
  }
  for (const V3d& mean : means) {
    const V3d off = mean - truth.e;
    truth.variance += off * off / double(truth_groups * (truth_groups - 1));
  }
  return truth;
}

bool light_reaches(const LitScene& lit, const V3f& p, const V3f& n, int paths, std::uint64_t index,
                   const TruthParams& params) {
  const WhitePoint white = white_point(lit, p, n, params);
  RandomStream random(params.seed, StreamPurpose::truth, 2 * index + 1);
  for (int i = 0; i < paths; ++i) {
    if (!is_black(trace_scattered(lit, white.surface, n, white.path, random))) return true;
  }
  return false;
}

}  // namespace ivory
