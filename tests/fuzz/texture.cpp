// Images of materials: PNG, JPEG and WebP, from memory.
#include "tests/fuzz/support.h"
#include "tracer/gltf/images.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ivory;
  Image image;
  const std::string cause = gltf::decode_image({data, size}, image);
  if (!cause.empty()) return 0;
  fuzz::require(image.width > 0 && image.height > 0, "an image without size");
  fuzz::require(image.rgba.size() == std::size_t(image.width) * std::size_t(image.height) * 4, "the image's size");
  return 0;
}
