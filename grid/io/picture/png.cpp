#include <array>
#include <cstdint>
#include <fstream>
#include <string_view>

#include "grid/io/picture/formats.h"

namespace ivory {

std::optional<Primaries> png_primaries(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(8);
  std::optional<Primaries> found;
  std::array<char, 32> bytes{};
  const auto big_endian = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value << 8U | std::uint8_t(bytes[i]);
    return value;
  };
  while (file.read(bytes.data(), 8)) {
    const std::uint32_t length = big_endian(0);
    const std::string type(bytes.data() + 4, 4);
    if (type == "IDAT" || type == "IEND") break;
    if (type == "sRGB" || type == "iCCP") return std::nullopt;
    if (type == "cHRM" && length == 32) {
      if (!file.read(bytes.data(), 32)) break;
      const auto xy = [&](std::size_t at) { return Imath::V2d(big_endian(at) / 1e5, big_endian(at + 4) / 1e5); };
      found = Primaries{xy(8), xy(16), xy(24), xy(0)};
      file.seekg(4, std::ios::cur);
    } else {
      file.seekg(std::int64_t(length) + 4, std::ios::cur);
    }
  }
  return found;
}

}  // namespace ivory
