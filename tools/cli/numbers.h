// Numbers as people write and read them: texts of the command line to values, values to text.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "grid/base/types.h"
#include "tools/cli/usage_error.h"

namespace ivory {

// All of `text` as a plain number; nothing for anything else. "nan" and "inf" are numbers here.
std::optional<double> parse_number(std::string_view text);
std::optional<float> parse_float(std::string_view text);

// Parsers of option values; `option` is named in the UsageError they throw for anything else. Not CLI11's own:
// CLI::AsNumberWithUnit reads 1.5k or numbers beyond 2^53 exactly, but not both, and takes -1 for 2^64 - 1; its
// delimiter(',') takes nan, and most lists here are parts of longer texts (boxes, FILE.glb@X,Y,Z, repeated options).

// "8m" = 8,000,000, "1.5k" = 1500, "2g"; whole numbers below 2^63 only.
std::uint64_t parse_count(std::string_view option, std::string_view text);
// "NX,NY,NZ", or "N" for all three; each from `least` to 65536.
V3i parse_size3(std::string_view option, std::string_view text, int least);
// "640x480", each from 1 to 65536.
Imath::V2i parse_image_size(std::string_view option, std::string_view text);
// "A:B", counts with A < B, half open.
std::pair<std::uint64_t, std::uint64_t> parse_range(std::string_view option, std::string_view text);
// "X,Y,Z", finite. Places in the world are double: see grid/base/anchor.h.
V3d parse_vector3(std::string_view option, std::string_view text);
// `count` finite numbers separated by commas; `form` shows the user how: "X,Y,Z,RADIUS".
std::vector<double> parse_numbers(std::string_view option, std::string_view text, std::size_t count,
                                  std::string_view form);

// The double that prints as the float does: 0.1, not 0.10000000149011612.
double shortest(float value);
// A local position in the world (grid/base/anchor.h), as it is printed.
std::array<double, 3> shortest(const V3f& p_local, const V3d& anchor_m);

// "1.20 M", "850 k", "12": three significant digits.
std::string format_count(double count);
// "0:43", "1:02:03".
std::string format_duration(double seconds);
// "288 KiB", "8.56 MiB".
std::string format_bytes(std::uint64_t bytes);

}  // namespace ivory
