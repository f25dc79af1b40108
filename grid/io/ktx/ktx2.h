// KTX 2.0 textures (Khronos' KTX File Format Specification, version 2.0): 2D, 3D and cube maps of floats, as engines on
// WebGL, WebGPU, Vulkan and Metal read them.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace ivory {

enum class Ktx2Format {
  rgba16f,   // VK_FORMAT_R16G16B16A16_SFLOAT, 97
  rgba32f,   // VK_FORMAT_R32G32B32A32_SFLOAT, 109
  e5b9g9r9,  // VK_FORMAT_E5B9G9R9_UFLOAT_PACK32, 123
};

enum class Ktx2Compression { none, zstd };

struct Ktx2Texture {
  Ktx2Format format = Ktx2Format::rgba16f;
  int width = 1;
  int height = 1;
  int depth = 0;  // 0: not a 3D texture
  int faces = 1;  // 6: a cube map, faces +X -X +Y -Y +Z -Z within each level
  // Level 0, the largest, first; each half as large as the one before, rounded down, at least 1. Texels little endian,
  // x fastest, then y, z, face; the first row is the top of a 2D picture.
  std::vector<std::string> levels;
  std::map<std::string, std::string> notes;  // keys without "KTX" in front, and text
};

// Bytes of a texel.
int texel_bytes(Ktx2Format format);

// The whole file. Throws ParameterError where a level has not the bytes that its size asks for.
std::string ktx2_bytes(const Ktx2Texture& texture, Ktx2Compression compression);

}  // namespace ivory
