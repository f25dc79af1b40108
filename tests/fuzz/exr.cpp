// Baked .exr assets as any bytes.
#include "grid/io/exr.h"

#include "grid/io/cubemap.h"
#include "grid/io/difmap.h"
#include "grid/io/fiv.h"
#include "grid/io/lobes.h"
#include "tests/fuzz/support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ivory;
  if (!fuzz::attributes_fit(data, size)) return 0;
  const std::string path = fuzz::file_of(data, size, ".exr");
  const std::string kind = exr_asset_kind(path);
  fuzz::reads(path, [&] {
    if (kind == "difmap") read_difmap(path);
    if (kind == "cubemap") read_localized_cube(path);
    if (kind == "lobes") read_lobes(path);
    if (kind == "fiv" || kind.empty()) read_fiv(path);
  });
  return 0;
}
