#include "grid/io/ktx/ktx1.h"

#include <cstdint>

#include "grid/export/texel.h"
#include "grid/io/ktx/bytes.h"

namespace ivory {

std::string ktx1_cube_bytes(int size, const std::vector<std::vector<Rgb>>& levels,
                            const std::map<std::string, std::string>& notes) {
  std::string pairs;
  for (const auto& [key, value] : notes) {
    put(pairs, std::uint32_t(key.size() + value.size() + 2));
    pairs += key + '\0' + value + '\0';
    pad_to(pairs, 4);
  }
  // KTX 1.1 section 2; the enums are OpenGL's.
  constexpr std::uint32_t unsigned_int_10f_11f_11f_rev = 0x8C3B;
  constexpr std::uint32_t rgb = 0x1907;
  constexpr std::uint32_t r11f_g11f_b10f = 0x8C3A;
  std::string out("\xABKTX 11\xBB\r\n\x1A\n", 12);
  for (const std::uint32_t value :
       {0x04030201U, unsigned_int_10f_11f_11f_rev, 4U, rgb, r11f_g11f_b10f, rgb, std::uint32_t(size),
        std::uint32_t(size), 0U, 0U, 6U, std::uint32_t(levels.size()), std::uint32_t(pairs.size())})
    put(out, value);
  out += pairs;
  for (const std::vector<Rgb>& level : levels) {
    put(out, std::uint32_t(level.size() / 6 * 4));  // of one face, in cube maps that are no arrays
    for (const Rgb& texel : level) put(out, pack_float11(texel));
  }
  return out;
}

}  // namespace ivory
