// KTX2 files as a reader meets them, from the specification alone, not by the writer under test.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <half.h>
#include <zstd.h>

#include "grid/base/types.h"

namespace ivory {

struct Ktx2Read {
  std::uint32_t vk_format = 0, type_size = 0, width = 0, height = 0, depth = 0, layers = 0, faces = 0, scheme = 0;
  std::vector<std::string> levels;  // uncompressed
  std::vector<std::uint64_t> offsets;
  std::string descriptor;
  std::map<std::string, std::string> notes;
};

inline std::uint64_t number_at(const std::string& bytes, std::size_t at, unsigned size) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < size; ++i) value |= std::uint64_t(std::uint8_t(bytes.at(at + i))) << (8 * i);
  return value;
}

inline Ktx2Read read_ktx2(const std::string& bytes) {
  const auto word = [&](std::size_t at) { return std::uint32_t(number_at(bytes, at, 4)); };
  const std::string identifier("\xABKTX 20\xBB\r\n\x1A\n", 12);
  if (bytes.substr(0, 12) != identifier) throw std::runtime_error("no KTX2 file");
  Ktx2Read out{word(12), word(16), word(20), word(24), word(28), word(32), word(36), word(44), {}, {}, {}, {}};
  const std::uint32_t levels = word(40);
  out.descriptor = bytes.substr(word(48), word(52));
  for (std::size_t at = word(56); at < word(56) + word(60);) {
    const std::size_t size = word(at);
    const std::string pair = bytes.substr(at + 4, size);
    const std::size_t end = pair.find('\0');
    out.notes[pair.substr(0, end)] = pair.substr(end + 1, pair.size() - end - 2);  // without the last NUL
    at += 4 + (size + 3) / 4 * 4;
  }
  for (std::uint32_t level = 0; level < levels; ++level) {
    const std::size_t entry = 80 + 24 * std::size_t(level);
    const std::uint64_t offset = number_at(bytes, entry, 8);
    const std::string data = bytes.substr(offset, number_at(bytes, entry + 8, 8));
    std::string whole(number_at(bytes, entry + 16, 8), '\0');
    if (out.scheme == 2) {
      if (ZSTD_decompress(whole.data(), whole.size(), data.data(), data.size()) != whole.size())
        throw std::runtime_error("zstd data is damaged");
    } else {
      whole = data;
    }
    out.offsets.push_back(offset);
    out.levels.push_back(whole);
  }
  return out;
}

// Four channels of texel i of level 0.
inline V4f ktx2_texel(const Ktx2Read& file, std::size_t i) {
  const std::string& data = file.levels.at(0);
  V4f out(0, 0, 0, 1);
  if (file.vk_format == 123) {  // Vulkan: mantissa times 2^(exponent - 15 - 9)
    const auto word = std::uint32_t(number_at(data, 4 * i, 4));
    const double step = std::exp2(double(word >> 27U) - 24);
    for (unsigned c = 0; c < 3; ++c) out[c] = float(double(word >> (9 * c) & 511U) * step);
    return out;
  }
  for (unsigned c = 0; c < 4; ++c) {
    if (file.vk_format == 97) {
      half h;
      h.setBits(std::uint16_t(number_at(data, 8 * i + 2 * c, 2)));
      out[c] = h;
    } else {
      out[c] = std::bit_cast<float>(std::uint32_t(number_at(data, 16 * i + 4 * c, 4)));
    }
  }
  return out;
}

// What a shader reads at direction d of a cube, nearest texel: Vulkan 1.3 section 16.5.4.
inline V4f cube_texel_at(const Ktx2Read& file, const V3d& d) {
  const V3d a(std::abs(d.x), std::abs(d.y), std::abs(d.z));
  int face = 0;
  double s = 0;
  double t = 0;
  double m = 1;
  if (a.x >= a.y && a.x >= a.z) {
    face = d.x > 0 ? 0 : 1;
    s = d.x > 0 ? -d.z : d.z;
    t = -d.y;
    m = a.x;
  } else if (a.y >= a.z) {
    face = d.y > 0 ? 2 : 3;
    s = d.x;
    t = d.y > 0 ? d.z : -d.z;
    m = a.y;
  } else {
    face = d.z > 0 ? 4 : 5;
    s = d.z > 0 ? d.x : -d.x;
    t = -d.y;
    m = a.z;
  }
  const int size = int(file.width);
  const auto index = [&](double x) { return std::min(int((0.5 * x / m + 0.5) * size), size - 1); };
  return ktx2_texel(file, std::size_t((face * size + index(t)) * size + index(s)));
}

}  // namespace ivory
