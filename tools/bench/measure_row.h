// One loop and its bound, measured in turn. Private to the rows of `ivory bench all`.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <tbb/global_control.h>

#include "tools/bench/clock.h"
#include "tools/bench/median.h"
#include "tools/bench/rows.h"

namespace ivory {

// work_s() and bound_s() do `count` units each and return the process's own seconds. A round that warms up is left out.
template <typename Work, typename Bound>
BenchRow measure_seconds(const BenchAllParams& params, BenchRow row, double count, const Work& work_s,
                         const Bound& bound_s) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(params.threads));
  std::vector<double> work;
  std::vector<double> bound;
  std::vector<double> ratio;
  for (int round = 0; round <= params.rounds; ++round) {
    const double bound_time = bound_s() / params.threads;
    const double work_time = work_s() / params.threads;
    if (round == 0) continue;
    work.push_back(work_time);
    bound.push_back(bound_time);
    ratio.push_back(bound_time / work_time);
  }
  row.per_s = count / median(work);
  row.bound_per_s = count / median(bound);
  row.ratio = median(ratio);
  return row;
}

template <typename Work, typename Bound>
BenchRow measure_row(const BenchAllParams& params, BenchRow row, double count, const Work& work, const Bound& bound) {
  return measure_seconds(
      params, std::move(row), count, [&] { return time_of(work).cpu_s; }, [&] { return time_of(bound).cpu_s; });
}

// A row yet to be measured; `measure` fills in all but the name.
struct RowMaker {
  std::string name;
  std::function<BenchRow(const BenchAllParams&)> measure;
};
std::vector<RowMaker> scene_rows();
std::vector<RowMaker> table_rows();

}  // namespace ivory
