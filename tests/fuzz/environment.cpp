// Environment maps of every format, told by their first bytes.
#include "grid/io/environment.h"

#include <cmath>
#include <string_view>
#include <utility>

#include "tests/fuzz/support.h"

namespace {

// OpenImageIO asks the name first; without one that fits it tries all formats in turn.
std::string extension_of(std::string_view bytes) {
  constexpr std::pair<std::string_view, const char*> formats[] = {{"\x76\x2f\x31\x01", ".exr"},
                                                                  {"#?", ".hdr"},
                                                                  {"\x89PNG", ".png"},
                                                                  {"\xFF\xD8\xFF", ".jpg"},
                                                                  {"II*\0", ".tif"},
                                                                  {"MM\0*", ".tif"},
                                                                  {"BM", ".bmp"},
                                                                  {"RIFF", ".webp"},
                                                                  {"GIF8", ".gif"},
                                                                  {"8BPS", ".psd"},
                                                                  {"DDS ", ".dds"},
                                                                  {"SDPX", ".dpx"},
                                                                  {"XPDS", ".dpx"},
                                                                  {"P6", ".ppm"},
                                                                  {"Pf", ".pfm"},
                                                                  {"PF", ".pfm"},
                                                                  {"\x01\xda", ".sgi"},
                                                                  {"\x00\x00\x02", ".tga"},
                                                                  {"\x00\x00\x0A", ".tga"}};
  for (const auto& [magic, extension] : formats)
    if (bytes.starts_with(magic)) return extension;
  return ".hdr";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ivory;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::string extension = extension_of(bytes);
  if (extension == ".exr" && !fuzz::attributes_fit(data, size)) return 0;
  const std::string path = fuzz::file_of(data, size, extension);
  fuzz::reads(path, [&] {
    const EnvironmentMap map = load_environment(path);
    fuzz::require(
        map.width > 0 && map.height > 0 && map.radiance.size() == std::size_t(map.width) * std::size_t(map.height),
        "the map's size");
    for (const Rgb& radiance : map.radiance)
      for (int c = 0; c < 3; ++c)
        fuzz::require(radiance[c] >= 0 && std::isfinite(radiance[c]), "radiance that is negative or not finite");
  });
  return 0;
}
