#include "grid/io/ktx/ktx2.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include <zstd.h>

#include "grid/base/error.h"
#include "grid/io/ktx/bytes.h"

namespace ivory {

namespace {

constexpr std::uint32_t scheme_zstd = 2;
constexpr int zstd_level = 19;  // volumes are small and are loaded more often than written

struct FormatFacts {
  std::uint32_t vk_format;
  std::uint32_t type_size;
  int texel_bytes;
};

FormatFacts facts_of(Ktx2Format format) {
  switch (format) {
    case Ktx2Format::rgba16f:
      return {97, 2, 8};
    case Ktx2Format::rgba32f:
      return {109, 4, 16};
    case Ktx2Format::e5b9g9r9:
      return {123, 4, 4};
  }
  return {};
}

// One sample of a basic data format descriptor (Khronos Data Format Specification 1.3, section 5.6).
void put_sample(std::string& out, unsigned offset, unsigned bits, unsigned channel, std::uint32_t lower,
                std::uint32_t upper) {
  put(out, std::uint16_t(offset));
  put(out, std::uint8_t(bits - 1));
  put(out, std::uint8_t(channel));
  put(out, std::uint32_t(0));  // position within the texel block
  put(out, lower);
  put(out, upper);
}

// The descriptor of linear Rec.709 colours with straight alpha. Bytes of the plane are those before compression, as the
// specification has it since revision 4 (before, 0 stood there in compressed files; readers go by vkFormat).
std::string data_format_descriptor(Ktx2Format format) {
  std::string samples;
  if (format == Ktx2Format::e5b9g9r9) {
    // Each channel is a mantissa and the exponent that all share. 8448 = 2^8 + 2^13 is the mantissa of 1 shifted by the
    // exponent's bias: section 5.13's example of this format.
    constexpr unsigned exponent_qualifier = 0x20;
    for (unsigned channel = 0; channel < 3; ++channel) {
      put_sample(samples, 9 * channel, 9, channel, 0, 8448);
      put_sample(samples, 27, 5, channel | exponent_qualifier, 15, 31);
    }
  } else {
    constexpr unsigned signed_float = 0xC0;
    const unsigned bits = format == Ktx2Format::rgba16f ? 16 : 32;
    constexpr std::array<unsigned, 4> channels{0, 1, 2, 15};  // red, green, blue, alpha
    for (unsigned i = 0; i < 4; ++i)
      put_sample(samples, i * bits, bits, channels[i] | signed_float, 0xBF800000U, 0x3F800000U);  // -1.0F, 1.0F
  }
  std::string block;
  put(block, std::uint32_t(0));  // vendor Khronos, type basic format
  put(block, std::uint16_t(2));  // version 1.3 of the specification
  put(block, std::uint16_t(24 + samples.size()));
  put(block, std::uint8_t(1));   // model RGBSDA
  put(block, std::uint8_t(1));   // primaries BT.709
  put(block, std::uint8_t(1));   // transfer linear
  put(block, std::uint8_t(0));   // alpha straight
  put(block, std::uint32_t(0));  // blocks of one texel
  put(block, std::uint64_t(facts_of(format).texel_bytes));
  std::string out;
  put(out, std::uint32_t(4 + block.size() + samples.size()));
  return out + block + samples;
}

// Sorted by key, as the specification asks (section 3.11); std::map does so by code units.
std::string key_value_data(const Ktx2Texture& texture) {
  std::map<std::string, std::string> all = texture.notes;
  all["KTXwriter"] = std::string("ivory ") + IVORY_VERSION;
  std::string out;
  for (const auto& [key, value] : all) {
    put(out, std::uint32_t(key.size() + value.size() + 2));
    out += key + '\0' + value + '\0';
    pad_to(out, 4);
  }
  return out;
}

std::string compressed(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), zstd_level);
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the one thing that can go wrong with a buffer that large
  out.resize(size);
  return out;
}

}  // namespace

int texel_bytes(Ktx2Format format) { return facts_of(format).texel_bytes; }

std::string ktx2_bytes(const Ktx2Texture& texture, Ktx2Compression compression) {
  const FormatFacts facts = facts_of(texture.format);
  for (std::size_t level = 0; level < texture.levels.size(); ++level) {
    const auto side = [&](int n) { return std::size_t(std::max(1, n >> int(level))); };
    const std::size_t texels =
        side(texture.width) * side(texture.height) * side(texture.depth) * std::size_t(texture.faces);
    if (texture.levels[level].size() != texels * std::size_t(facts.texel_bytes))
      throw ParameterError("levels", "level " + std::to_string(level) + " has not the bytes of its texels");
  }
  const bool zstd = compression == Ktx2Compression::zstd;
  std::vector<std::string> data;
  for (const std::string& level : texture.levels) data.push_back(zstd ? compressed(level) : level);
  const std::string descriptor = data_format_descriptor(texture.format);
  const std::string notes = key_value_data(texture);

  constexpr std::size_t header_bytes = 80;
  constexpr std::size_t level_entry_bytes = 24;
  const std::size_t descriptor_at = header_bytes + level_entry_bytes * data.size();
  const std::size_t notes_at = descriptor_at + descriptor.size();
  // Levels lie from the smallest to the largest (section 3.12), uncompressed ones on multiples of their texels.
  const std::size_t alignment = zstd ? 1 : std::lcm(std::size_t(facts.texel_bytes), std::size_t(4));
  std::vector<std::size_t> offset(data.size());
  std::size_t end = notes_at + notes.size();
  for (std::size_t level = data.size(); level-- > 0;) {
    offset[level] = (end + alignment - 1) / alignment * alignment;
    end = offset[level] + data[level].size();
  }

  std::string out("\xABKTX 20\xBB\r\n\x1A\n", 12);
  put(out, facts.vk_format);
  put(out, facts.type_size);
  put(out, std::uint32_t(texture.width));
  put(out, std::uint32_t(texture.height));
  put(out, std::uint32_t(texture.depth));
  put(out, std::uint32_t(0));  // layers: no array
  put(out, std::uint32_t(texture.faces));
  put(out, std::uint32_t(data.size()));
  put(out, zstd ? scheme_zstd : 0U);
  put(out, std::uint32_t(descriptor_at));
  put(out, std::uint32_t(descriptor.size()));
  put(out, std::uint32_t(notes_at));
  put(out, std::uint32_t(notes.size()));
  put(out, std::uint64_t(0));  // no global data
  put(out, std::uint64_t(0));
  for (std::size_t level = 0; level < data.size(); ++level) {
    put(out, std::uint64_t(offset[level]));
    put(out, std::uint64_t(data[level].size()));
    put(out, std::uint64_t(texture.levels[level].size()));
  }
  out += descriptor + notes;
  for (std::size_t level = data.size(); level-- > 0;) {
    out.resize(offset[level]);
    out += data[level];
  }
  return out;
}

}  // namespace ivory
