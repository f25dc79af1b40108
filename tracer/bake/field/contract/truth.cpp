#include "tracer/bake/field/contract/truth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tracer/core/sampler.h"
#include "tracer/render/path_tracer.h"
#include "tracer/render/probe.h"

namespace ivory {
namespace {

// The calls for random numbers of a path that are drawn evenly: those of its first bounce and of the light sampled at
// its end.
constexpr std::uint32_t even_calls = 8;

// One bounce more than the light may take: the receiver's own.
PathParams path_params(const TruthParams& params) {
  PathParams path;
  path.max_bounces = params.max_bounces + 1;
  path.indirect_only = params.indirect_only;
  return path;
}

}  // namespace

Truth trace_truth(const LitScene& lit, const V3f& p, const V3f& n, int paths, std::uint64_t index,
                  const TruthParams& params) {
  const Surface white = white_receiver(lit, p, n);
  const PathParams path = path_params(params);
  RandomStream random(params.seed, StreamPurpose::truth, 2 * index);
  const int group_paths = (paths + truth_groups - 1) / truth_groups;
  std::array<V3d, truth_groups> means;
  Truth truth;
  for (V3d& mean : means) {
    const std::uint32_t key = random.next_u32();
    mean = V3d(0, 0, 0);
    for (int i = 0; i < group_paths; ++i) {
      random.begin_sample(std::uint32_t(i), key, even_calls);
      mean += V3d(trace_scattered(lit, white, n, path, random) * pi);
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

double best_paths(double path_variance, double square) {
  constexpr double spread_of_squares = 9;
  return std::sqrt(2 / spread_of_squares) * path_variance / square;
}

bool light_reaches(const LitScene& lit, const V3f& p, const V3f& n, int paths, std::uint64_t index,
                   const TruthParams& params) {
  const Surface white = white_receiver(lit, p, n);
  const PathParams path = path_params(params);
  RandomStream random(params.seed, StreamPurpose::truth, 2 * index + 1);
  for (int i = 0; i < paths; ++i) {
    if (!is_black(trace_scattered(lit, white, n, path, random))) return true;
  }
  return false;
}

}  // namespace ivory
