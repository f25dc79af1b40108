#include "tracer/bake/fiv/choose.h"

#include <algorithm>
#include <array>

namespace ivory {

namespace {

// Levels that are baked together: pictures of the occluder along each light cost as much as some 50,000 samples, so
// that the coarse tables come for nothing beside each other, and the finest are each worth a decision.
constexpr std::array<std::size_t, 5> pass_begin{0, 4, 6, 7, 8};
// Each of 2.8 times as many samples as the one before.
const std::array<V3i, 8> levels{V3i(16, 9, 6),   V3i(24, 13, 9),  V3i(32, 17, 12),  V3i(48, 25, 17),
                                V3i(64, 33, 24), V3i(96, 49, 34), V3i(128, 65, 48), most_fiv_samples};
// Where a level leaves more than this of the error of the one before, more samples are wasted: the rest is the
// vectors'.
constexpr double worth_going_on = 0.9;

struct Candidate {
  const FivTable* six_or_one = nullptr;
  int hemispheres = 1;
  std::size_t numbers = 0;  // of floats
};

V3i at_most(const V3i& size, const V3i& most) {
  return {std::min(size.x, most.x), std::min(size.y, most.y), std::min(size.z, most.z)};
}

}  // namespace

FivChoice choose_fiv(const FivOccluder& occluder, const CubeMap& environment, const FivParams& params,
                     const FivTruth& pilot, double target, std::span<const int> hemispheres) {
  FivParams whole = params;
  // A table of six hemispheres holds that of one.
  whole.hemispheres = *std::max_element(hemispheres.begin(), hemispheres.end());
  whole.radii.clear();
  FivChoice best;
  bool first = true;
  std::vector<double> least;  // error of each level, of as many hemispheres as there may be
  for (std::size_t pass = 0; pass + 1 < pass_begin.size() && !best.met; ++pass) {
    const std::size_t n = least.size();
    if (n > 1 && least[n - 1] > worth_going_on * least[n - 2]) break;
    std::vector<V3i> sizes;
    for (std::size_t level = pass_begin[pass]; level < pass_begin[pass + 1]; ++level) {
      const V3i size = at_most(levels[level], params.samples);
      if (level > 0 && size == at_most(levels[level - 1], params.samples)) break;
      sizes.push_back(size);
    }
    if (sizes.empty()) break;
    const std::vector<FivTable> tables = bake_fivs(occluder, environment, whole, sizes);
    std::vector<Candidate> candidates;
    for (const FivTable& table : tables) {
      least.push_back(fiv_error(table, pilot).error);
      for (const int count : hemispheres)
        candidates.push_back({&table, count, fiv_sample_count(table) * std::size_t(3 * fiv_function_count(count))});
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.numbers < b.numbers; });
    for (const Candidate& candidate : candidates) {
      const bool is_part = candidate.hemispheres == 1 && whole.hemispheres == 6;
      FivTable table = is_part ? first_hemisphere(*candidate.six_or_one) : *candidate.six_or_one;
      const MeasuredError error = fiv_error(table, pilot);
      const bool met = error.high <= target;
      if (first || met || error.high < best.predicted.high) best = {std::move(table), error, met};
      first = false;
      if (met) break;
    }
  }
  return best;
}

}  // namespace ivory
