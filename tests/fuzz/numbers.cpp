// The texts of options that hold numbers: counts, sizes, ranges, boxes.
#include "tools/cli/numbers.h"

#include <cmath>
#include <string_view>

#include "tests/fuzz/support.h"

namespace {

using namespace ivory;

template <typename Parse>
void parse(const Parse& read) {
  try {
    read();
  } catch (const UsageError& error) {
    fuzz::require(std::string(error.what()).starts_with("--option"), "an option without its name");
  }
}

}  // namespace

// The first byte chooses the parser: an exception costs more than all of them.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::string_view option = "--option";
  switch (data[0] % 8) {
    case 0:
      parse([&] { fuzz::require(parse_count(option, text) < std::uint64_t(1) << 63U, "a count beyond int64"); });
      break;
    case 1:
      parse([&] {
        const auto [begin, end] = parse_range(option, text);
        fuzz::require(begin < end && end < std::uint64_t(1) << 63U, "a range");
      });
      break;
    case 2:
      parse([&] {
        const V3i v = parse_size3(option, text, 2);
        for (int i = 0; i < 3; ++i) fuzz::require(v[i] >= 2 && v[i] <= 65536, "a size");
      });
      break;
    case 3:
      parse([&] {
        const Imath::V2i v = parse_image_size(option, text);
        fuzz::require(v.x >= 1 && v.y >= 1 && v.x <= 65536 && v.y <= 65536, "an image's size");
      });
      break;
    case 4:
      parse([&] {
        const V3d v = parse_vector3(option, text);
        fuzz::require(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z), "a vector that is not finite");
      });
      break;
    case 5:
      parse([&] {
        for (const double number : parse_numbers(option, text, 7, "seven"))
          fuzz::require(std::isfinite(number), "a number that is not finite");
      });
      break;
    case 6:
      if (const auto value = parse_float(text); value && std::isfinite(*value))
        fuzz::require(float(shortest(*value)) == *value, "the shortest text of a number");
      break;
    default:
      if (const auto value = parse_number(text))
        fuzz::require(!format_duration(*value).empty() && !format_count(*value).empty(), "a number without text");
  }
  return 0;
}
