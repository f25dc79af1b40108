#include "tools/bench/rows.h"

#include "tools/bench/measure_row.h"

namespace ivory {

std::vector<BenchRow> bench_all(const BenchAllParams& params, const std::function<void(int, int)>& progress) {
  std::vector<RowMaker> makers = photon_rows();
  for (const auto& more : {scene_rows(), table_rows()}) makers.insert(makers.end(), more.begin(), more.end());
  std::vector<BenchRow> rows;
  for (const RowMaker& make : makers) {
    progress(int(rows.size()), int(makers.size()));
    rows.push_back(make(params));
  }
  return rows;
}

}  // namespace ivory
