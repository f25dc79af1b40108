// glTF and GLB, with buffers and images in the file or in data: URIs; no other file lies where theirs could.
#include "tests/fuzz/support.h"
#include "tests/support/scene_check.h"
#include "tracer/gltf/loader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ivory;
  const std::string path = fuzz::file_of(data, size, ".gltf");
  fuzz::reads(path, [&] {
    const LoadedScene loaded = load_gltf(path);
    const std::string fault = find_fault(loaded.scene);
    fuzz::require(fault.empty(), "a scene with " + fault);
    for (const std::string& warning : loaded.warnings)
      fuzz::require(warning.starts_with(path) && warning.find('\n') == std::string::npos, "warning '" + warning + "'");
  });
  return 0;
}
