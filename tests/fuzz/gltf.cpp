// glTF and GLB, with buffers and images in the file or in data: URIs; no other file lies where theirs could. Animated
// ones are posed at a time, too.
#include <string_view>

#include "grid/base/error.h"
#include "tests/fuzz/support.h"
#include "tests/support/scene_check.h"
#include "tracer/gltf/loader.h"

namespace {

using namespace ivory;

void load(const std::string& path, const LoadParams& params) {
  fuzz::reads(path, [&] {
    try {
      const LoadedScene loaded = load_gltf(path, params);
      const std::string fault = find_fault(loaded.scene);
      fuzz::require(fault.empty(), "a scene with " + fault);
      for (const std::string& warning : loaded.warnings)
        fuzz::require(warning.starts_with(path) && warning.find('\n') == std::string::npos,
                      "warning '" + warning + "'");
    } catch (const ParameterError& error) {
      fuzz::require(params.time_s && error.parameter() == "time", error.what());  // without an animation
    }
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::file_of(data, size, ".gltf");
  load(path, {});
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (text.find("\"animations\"") == std::string_view::npos) return 0;
  LoadParams posed;
  posed.time_s = 0.4;
  posed.scale = 0.01;
  load(path, posed);
  return 0;
}
