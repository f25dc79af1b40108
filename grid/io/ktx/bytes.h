// Little-endian numbers in a growing string of bytes.
#pragma once

#include <bit>
#include <cstdint>
#include <string>

namespace ivory {

template <typename Unsigned>
void put(std::string& out, Unsigned value) {
  for (unsigned i = 0; i < sizeof(Unsigned); ++i) out.push_back(char(value >> (8U * i) & 0xFFU));
}
inline void put_float(std::string& out, float value) { put(out, std::bit_cast<std::uint32_t>(value)); }

// Zeros up to the next multiple.
inline void pad_to(std::string& out, std::size_t multiple) {
  out.resize((out.size() + multiple - 1) / multiple * multiple);
}

}  // namespace ivory
