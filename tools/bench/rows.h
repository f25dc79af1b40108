// Inner loops beside their bounds: each row of `ivory bench all`.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace ivory {

struct BenchRow {
  std::string name;   // of the loop
  std::string unit;   // what is counted
  std::string bound;  // what it is compared with
  double per_s = 0;   // units a second, in the process's own time over the threads
  double bound_per_s = 0;
  double ratio = 0;  // the first over the second: median of rounds in which both are measured in turn
};

struct BenchAllParams {
  int threads = 1;
  int rounds = 5;
  double scale = 1;  // of the amount of work
  std::string only;  // rows whose names have this in them; empty: all
};

// Measures the rows; progress(done, all) is called before each. Throws ParameterError("only") where there are none.
std::vector<BenchRow> bench_all(const BenchAllParams& params, const std::function<void(int, int)>& progress);

}  // namespace ivory
