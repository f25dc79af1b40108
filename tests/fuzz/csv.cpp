// Tables of points.
#include <cmath>

#include "tests/fuzz/support.h"
#include "tools/input/points.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ivory;
  const std::string path = fuzz::file_of(data, size, ".csv");
  fuzz::reads(path, [&] {
    const PointsTable table = read_points_csv(path);
    fuzz::require(!table.p.empty() && table.p.size() == table.n.size() && table.p.size() == table.rows.size(),
                  "as many points as normals and rows");
    for (std::size_t i = 0; i < table.p.size(); ++i) {
      const V3f& p = table.p[i];
      fuzz::require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "a point that is not finite");
      fuzz::require(std::abs(table.n[i].length() - 1) < 1e-5F, "a normal that is not of unit length");
    }
  });
  return 0;
}
