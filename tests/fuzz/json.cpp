// JSON assets: SH9 and sphere sets.
#include "grid/io/json.h"

#include <cmath>

#include "grid/io/sh9.h"
#include "grid/io/sphere_set.h"
#include "tests/fuzz/support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ivory;
  const std::string path = fuzz::file_of(data, size, ".json");
  const std::string kind = json_asset_kind(path);
  const bool is_sh9 = fuzz::reads(path, [&] {
    const Rgb e = irradiance(to_float(sh9_matrices(read_sh9(path).sh)), V3f(0, 1, 0));
    for (int c = 0; c < 3; ++c) fuzz::require(e[c] >= 0 && std::isfinite(e[c]), "E that is negative or not finite");
  });
  const bool is_spheres = fuzz::reads(path, [&] {
    for (const Sphere& sphere : read_spheres(path).spheres) {
      const V3f& p = sphere.center;
      fuzz::require(std::isfinite(p.x + p.y + p.z) && sphere.radius_m > 0 && std::isfinite(sphere.radius_m),
                    "a sphere that is none");
    }
  });
  fuzz::require(!(is_sh9 && is_spheres), "a file of two kinds");
  // A file may say twice what it is.
  fuzz::require(!kind.empty() || !(is_sh9 || is_spheres), "a file of a kind that is not told");
  return 0;
}
