#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <locale>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/io/picture/formats.h"
#include "grid/io/picture/scan_order.h"

// After the reference manual's "Radiance File Formats" (Ward) and "Real Pixels" (Graphics Gems II, p. 80).

namespace ivory {

namespace {

constexpr int max_side = 1 << 16;

struct RadianceHeader {
  bool xyz = false;
  bool format_said = false;
  std::array<double, 3> divide_by{1, 1, 1};  // all EXPOSURE times all COLORCORR
  bool exposed = false;
  std::optional<Primaries> primaries;
  double gamma = 1;
  int width = 0;
  int height = 0;
  ScanOrder order;
  std::size_t data = 0;  // where the first line of the picture begins
};

class Reader {
 public:
  Reader(const std::string& path, const std::string& remedy, std::string_view bytes)
      : path_(path), remedy_(remedy), bytes_(bytes) {}

  RadianceHeader header() {
    RadianceHeader h;
    std::string_view text = line();  // "#?RADIANCE" or another program's name
    while (!(text = line()).empty()) read_entry(h, text);
    read_resolution(h, line());
    h.data = at_;
    return h;
  }

  // Four bytes a pixel, the file's lines one after the other.
  std::vector<std::uint8_t> pixels(const RadianceHeader& h) {
    const auto length = std::size_t(h.order.columns ? h.height : h.width);
    const auto lines = std::size_t(h.order.columns ? h.width : h.height);
    std::vector<std::uint8_t> out(length * lines * 4);
    for (std::size_t i = 0; i < lines; ++i) read_line(&out[i * length * 4], length);
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& cause) const { throw Error(path_, cause, remedy_); }
  [[noreturn]] void fail_damaged(const std::string& what) const { fail("is damaged (" + what + ")"); }

  std::string_view line() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) fail_damaged("its header has no end");
    std::string_view text = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    if (text.ends_with('\r')) text.remove_suffix(1);
    return text;
  }

  std::vector<double> numbers(std::string_view entry, std::string_view text, std::size_t count) const {
    std::istringstream in{std::string(text)};
    in.imbue(std::locale::classic());
    std::vector<double> out;
    for (double value = 0; in >> value;) out.push_back(value);
    for (const double value : out)
      if (!std::isfinite(value)) out.clear();
    if (out.size() != count) fail(fmt::format("has a header entry {} that cannot be read ('{}')", entry, text));
    return out;
  }

  // Indented entries are those of pictures that this one was made from.
  void read_entry(RadianceHeader& h, std::string_view text) const {
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos || text.front() == ' ' || text.front() == '\t' || text.front() == '#') return;
    const std::string_view key = text.substr(0, equals);
    std::string_view value = text.substr(equals + 1);
    while (value.starts_with(' ') || value.starts_with('\t')) value.remove_prefix(1);
    while (value.ends_with(' ') || value.ends_with('\t')) value.remove_suffix(1);
    if (key == "FORMAT") {
      h.format_said = true;
      h.xyz = value == "32-bit_rle_xyze";
      if (!h.xyz && value != "32-bit_rle_rgbe")
        fail(fmt::format("is of the format '{}', neither 32-bit_rle_rgbe nor 32-bit_rle_xyze", value));
    } else if (key == "EXPOSURE") {
      const double exposure = numbers(key, value, 1)[0];
      scale(h, key, {exposure, exposure, exposure});
    } else if (key == "COLORCORR") {
      const std::vector<double> v = numbers(key, value, 3);
      scale(h, key, {v[0], v[1], v[2]});
    } else if (key == "PRIMARIES") {
      const std::vector<double> v = numbers(key, value, 8);
      // Photoshop writes eight zeros for those that it does not know.
      if (std::any_of(v.begin(), v.end(), [](double x) { return x != 0; }))
        h.primaries = Primaries{{v[0], v[1]}, {v[2], v[3]}, {v[4], v[5]}, {v[6], v[7]}};
    } else if (key == "GAMMA") {
      h.gamma = numbers(key, value, 1)[0];
    }
  }

  void scale(RadianceHeader& h, std::string_view key, const std::array<double, 3>& by) const {
    for (std::size_t c = 0; c < 3; ++c) {
      if (!(by[c] > 0)) fail(fmt::format("has a header entry {} that is not above 0", key));
      h.divide_by[c] *= by[c];
      h.exposed = h.exposed || by[c] != 1;
    }
  }

  // "-Y 512 +X 1024": lines run along the axis that comes last; Y counts upwards.
  void read_resolution(RadianceHeader& h, std::string_view text) const {
    std::istringstream in{std::string(text)};
    std::array<std::string, 2> axes;
    std::array<int, 2> sizes{0, 0};
    in >> axes[0] >> sizes[0] >> axes[1] >> sizes[1];
    const auto is_axis = [](const std::string& axis) {
      return axis == "+X" || axis == "-X" || axis == "+Y" || axis == "-Y";
    };
    if (!in || !is_axis(axes[0]) || !is_axis(axes[1]) || axes[0][1] == axes[1][1])
      fail_damaged(fmt::format("no resolution line, but '{}'", text.substr(0, 40)));
    for (const int size : sizes)
      if (size < 1 || size > max_side) fail(fmt::format("says that it is {} pixels along a side", size));
    h.order.columns = axes[0][1] == 'X';
    for (std::size_t i = 0; i < 2; ++i) {
      const bool x = axes[i][1] == 'X';
      (x ? h.width : h.height) = sizes[i];
      if (x)
        h.order.from_right = axes[i][0] == '-';
      else
        h.order.from_bottom = axes[i][0] == '+';
    }
  }

  std::uint8_t byte() {
    if (at_ >= bytes_.size()) fail_damaged("it ends early");
    return std::uint8_t(bytes_[at_++]);
  }

  void read_line(std::uint8_t* out, std::size_t length) {
    std::array<std::uint8_t, 4> first{};
    const bool long_enough = length >= 8 && length <= 0x7FFF;
    if (long_enough && bytes_.size() - at_ >= 4) std::memcpy(first.data(), &bytes_[at_], 4);
    if (first[0] != 2 || first[1] != 2 || first[2] >= 128) return read_old_line(out, length);
    at_ += 4;
    if (std::size_t(first[2] << 8U | first[3]) != length) fail_damaged("a line of another length");
    for (std::size_t component = 0; component < 4; ++component) {
      for (std::size_t i = 0; i < length;) {
        std::size_t count = byte();
        const bool run = count > 128;
        if (run) count &= 127U;
        if (count == 0 || count > length - i) fail_damaged("a run beyond the end of its line");
        std::uint8_t value = run ? byte() : 0;
        for (const std::size_t end = i + count; i < end; ++i) {
          if (!run) value = byte();
          out[i * 4 + component] = value;
        }
      }
    }
  }

  // Flat pixels, among which (1, 1, 1, n) repeats the pixel before it n times; directly after another such, n counts
  // 256 times as much.
  void read_old_line(std::uint8_t* out, std::size_t length) {
    unsigned shift = 0;
    for (std::size_t i = 0; i < length;) {
      std::uint8_t* pixel = out + i * 4;
      for (int c = 0; c < 4; ++c) pixel[c] = byte();
      if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
        ++i;
        shift = 0;
        continue;
      }
      const std::size_t count = shift < 32 ? std::size_t(pixel[3]) << shift : length;
      if (i == 0 || count > length - i) fail_damaged("a run without a pixel, or beyond the end of its line");
      for (const std::size_t end = i + count; i < end; ++i) std::memcpy(out + i * 4, out + i * 4 - 4, 4);
      shift += 8;
    }
  }

  const std::string& path_;
  const std::string& remedy_;
  std::string_view bytes_;
  std::size_t at_ = 0;
};

std::string words(const std::array<double, 3>& v) {
  return v[0] == v[1] && v[1] == v[2] ? fmt::format("{:.6g}", v[0])
                                      : fmt::format("{:.6g} {:.6g} {:.6g}", v[0], v[1], v[2]);
}

}  // namespace

bool is_radiance_picture(const std::string& path) {
  std::array<char, 2> magic{};
  std::ifstream file(path, std::ios::binary);
  return bool(file.read(magic.data(), 2)) && magic[0] == '#' && magic[1] == '?';
}

StoredPicture read_radiance_picture(const std::string& path, const std::string& remedy) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  Reader reader(path, remedy, bytes);
  const RadianceHeader header = reader.header();
  const auto count = std::size_t(header.width) * std::size_t(header.height);
  check_claimed_size(path, header.width, header.height);
  check_memory(path, double(count) * (4 + 2 * sizeof(Rgb)), "scale it down");

  StoredPicture picture;
  picture.width = header.width;
  picture.height = header.height;
  picture.texels.resize(count);
  const std::vector<std::uint8_t> pixels = reader.pixels(header);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* p = &pixels[i * 4];
    const float scale = p[3] == 0 ? 0.0F : std::ldexp(1.0F, int(p[3]) - (128 + 8));
    for (unsigned c = 0; c < 3; ++c) {
      const float value = float(p[c]) * scale;
      picture.texels[i][c] = header.exposed ? float(value / header.divide_by[c]) : value;
    }
  }
  picture.texels = upright(std::move(picture.texels), header.width, header.height, header.order);

  if (header.exposed)
    picture.warnings.push_back("was exposed by " + words(header.divide_by) +
                               " (EXPOSURE, COLORCORR): values are divided by that");
  if (header.xyz) {
    picture.primaries = xyz_primaries;
  } else if (header.primaries) {
    picture.primaries = *header.primaries;
  }
  if (!header.format_said) picture.warnings.emplace_back("has no FORMAT in its header: 32-bit_rle_rgbe is assumed");
  if (header.gamma != 1)
    picture.color_warnings.push_back(
        fmt::format("has GAMMA={:g} in its header: it is ignored, values count as linear", header.gamma));
  return picture;
}

}  // namespace ivory
