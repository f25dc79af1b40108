#include "tools/bench/rows.h"

#include "grid/base/error.h"
#include "tools/bench/measure_row.h"

namespace ivory {

std::vector<BenchRow> bench_all(const BenchAllParams& params, const std::function<void(int, int)>& progress) {
  std::vector<RowMaker> makers;
  for (const auto& list : {scene_rows(), table_rows()}) {
    for (const RowMaker& maker : list) {
      if (maker.name.find(params.only) != std::string::npos) makers.push_back(maker);
    }
  }
  if (makers.empty()) throw ParameterError("only", "no row has '" + params.only + "' in its name");
  std::vector<BenchRow> rows;
  for (const RowMaker& maker : makers) {
    progress(int(rows.size()), int(makers.size()));
    rows.push_back(maker.measure(params));
    rows.back().name = maker.name;
  }
  return rows;
}

}  // namespace ivory
