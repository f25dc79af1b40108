// KTX files by the byte, as the specifications lay them out.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/export/texel.h"
#include "grid/io/file.h"
#include "grid/io/ktx/bytes.h"
#include "grid/io/ktx/ktx1.h"
#include "grid/io/ktx/ktx2.h"
#include "tests/support/folder_test.h"
#include "tests/tools/export/ktx2_reader.h"
#include "tests/tools/export/node_reader.h"

namespace ivory {
namespace {

Ktx2Texture volume(Ktx2Format format, int width, int height, int depth) {
  Ktx2Texture texture;
  texture.format = format;
  texture.width = width;
  texture.height = height;
  texture.depth = depth;
  texture.levels.emplace_back();
  for (int i = 0; i < width * height * depth; ++i) {
    const float value = 0.25F * float(i);
    if (format == Ktx2Format::e5b9g9r9) {
      put(texture.levels[0], pack_shared_exponent(Rgb(value, 2 * value, 3 * value)));
      continue;
    }
    for (const float channel : {value, 2 * value, -value, 1.0F}) {
      if (format == Ktx2Format::rgba16f)
        put(texture.levels[0], pack_half(channel));
      else
        put_float(texture.levels[0], channel);
    }
  }
  texture.notes = {{"ivory", "a note"}};
  return texture;
}

// Header, index and descriptor of the volume that Bevy ships (assets/irradiance_volumes/Example.vxgi.ktx2, 8 x 16 x 9
// texels of E5B9G9R9), but for where its data lie and the notes that ours has.
TEST(Ktx2, IsLaidOutAsBevysExample) {
  const std::string bytes = ktx2_bytes(volume(Ktx2Format::e5b9g9r9, 8, 16, 9), Ktx2Compression::none);
  const auto word = [&](std::size_t at) { return std::uint32_t(number_at(bytes, at, 4)); };
  EXPECT_EQ(bytes.substr(0, 12), std::string("\xABKTX 20\xBB\r\n\x1A\n", 12));
  const std::array<std::uint32_t, 9> header{123, 4, 8, 16, 9, 0, 1, 1, 0};
  for (std::size_t i = 0; i < header.size(); ++i) EXPECT_EQ(word(12 + 4 * i), header[i]) << i;
  EXPECT_EQ(word(48), 104U);  // descriptor
  EXPECT_EQ(word(52), 124U);
  EXPECT_EQ(word(56), 228U);  // notes
  EXPECT_EQ(number_at(bytes, 64, 8), 0U);
  EXPECT_EQ(number_at(bytes, 72, 8), 0U);
  EXPECT_EQ(number_at(bytes, 80, 8) % 4, 0U);
  EXPECT_EQ(number_at(bytes, 88, 8), 4608U);
  EXPECT_EQ(number_at(bytes, 96, 8), 4608U);
  EXPECT_EQ(number_at(bytes, 80, 8) + 4608, bytes.size());
  const std::array<std::uint32_t, 31> descriptor{
      0x7C, 0, 0x00780002, 0x00010101, 0, 4,  0,  0x00080000, 0, 0, 0x2100, 0x2004001B, 0, 15, 31, 0x01080009,
      0,    0, 0x2100,     0x2104001B, 0, 15, 31, 0x02080012, 0, 0, 0x2100, 0x2204001B, 0, 15, 31};
  for (std::size_t i = 0; i < descriptor.size(); ++i) EXPECT_EQ(word(104 + 4 * i), descriptor[i]) << i;
}

TEST(Ktx2, HoldsWhatWasGiven) {
  for (const Ktx2Format format : {Ktx2Format::rgba16f, Ktx2Format::rgba32f, Ktx2Format::e5b9g9r9}) {
    for (const Ktx2Compression compression : {Ktx2Compression::none, Ktx2Compression::zstd}) {
      const Ktx2Texture texture = volume(format, 5, 3, 7);
      const Ktx2Read file = read_ktx2(ktx2_bytes(texture, compression));
      EXPECT_EQ(file.levels, texture.levels);
      EXPECT_EQ(file.notes.at("ivory"), "a note");
      EXPECT_TRUE(file.notes.at("KTXwriter").starts_with("ivory "));
      if (compression == Ktx2Compression::none) {
        EXPECT_EQ(file.offsets[0] % std::uint64_t(texel_bytes(format)), 0U);
      }
      EXPECT_EQ(file.depth, 7U);
      EXPECT_EQ(file.faces, 1U);
      EXPECT_EQ(ktx2_texel(file, 40).y, 20);
    }
  }
}

// A cube with all its levels: the smallest lies first in the file.
TEST(Ktx2, CubeHasItsLevelsInOrder) {
  Ktx2Texture cube;
  cube.format = Ktx2Format::rgba16f;
  cube.width = cube.height = 4;
  cube.faces = 6;
  for (const int size : {4, 2, 1}) cube.levels.emplace_back(std::size_t(6 * size * size * 8), char('0' + size));
  const Ktx2Read file = read_ktx2(ktx2_bytes(cube, Ktx2Compression::none));
  EXPECT_EQ(file.levels, cube.levels);
  EXPECT_GT(file.offsets[0], file.offsets[1]);
  EXPECT_GT(file.offsets[1], file.offsets[2]);
  EXPECT_EQ(file.faces, 6U);
  EXPECT_EQ(file.depth, 0U);
  // RGBA of signed floats, 16 bits each, within -1 to 1: Khronos Data Format Specification, table of VK formats.
  const std::array<std::uint32_t, 4> sample{0xC00F0000U, 0, 0xBF800000U, 0x3F800000U};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(number_at(file.descriptor, 28 + 4 * i, 4), sample[i]);
  EXPECT_EQ(number_at(file.descriptor, 28 + 3 * 16, 4), 0xCF0F0030U);  // alpha
  cube.levels[1].pop_back();
  EXPECT_THROW(ktx2_bytes(cube, Ktx2Compression::none), ParameterError);
}

class KtxReaders : public FolderTest {};

TEST_F(KtxReaders, KtxParseAndThreeReadThem) {
  SKIP_WITHOUT_NODE_PACKAGES();
  const std::array<int, 3> vk_format{97, 109, 123};
  const std::array<int, 3> three_type{1016, 1015, 35902};  // HalfFloatType, FloatType, UnsignedInt5999Type
  for (int i = 0; i < 3; ++i) {
    for (const Ktx2Compression compression : {Ktx2Compression::none, Ktx2Compression::zstd}) {
      const auto format = Ktx2Format(i);
      const Ktx2Texture texture = volume(format, 4, 3, 5);
      const std::string file = path("volume.ktx2");
      write_file(file, ktx2_bytes(texture, compression), true);
      const nlohmann::json read = run_reader("ktx2.mjs", file);
      ASSERT_FALSE(read.is_discarded());
      EXPECT_EQ(read["vkFormat"], vk_format[std::size_t(i)]);
      EXPECT_EQ(read["depth"], 5);
      EXPECT_EQ(read["bytesPlane"], texel_bytes(format));
      EXPECT_EQ(read["samples"], i == 2 ? 6 : 4);
      EXPECT_EQ(read["uncompressed"][0], texture.levels[0].size());
      EXPECT_EQ(read["scheme"], compression == Ktx2Compression::zstd ? 2 : 0);
      const nlohmann::json& three = read["three"];
      EXPECT_TRUE(three["isData3DTexture"]);
      EXPECT_EQ(three["type"], three_type[std::size_t(i)]);
      EXPECT_EQ(three["width"], 4);
      EXPECT_EQ(three["height"], 3);
      EXPECT_EQ(three["depth"], 5);
      const unsigned size = i == 0 ? 2 : 4;
      const std::size_t values = std::min<std::size_t>(three["data"].size(), texture.levels[0].size() / size);
      for (std::size_t k = 0; k < values; ++k) {
        const std::uint64_t bits = number_at(texture.levels[0], size * k, size);
        if (i == 1) {
          EXPECT_EQ(three["data"][k].get<float>(), std::bit_cast<float>(std::uint32_t(bits)));
        } else {
          EXPECT_EQ(three["data"][k].get<std::uint64_t>(), bits);
        }
      }
    }
  }
}

// KTX 1.1 section 2, by the byte.
TEST(Ktx1, CubeIsLaidOutAsSpecified) {
  std::vector<std::vector<Rgb>> levels(2);
  for (int i = 0; i < 24; ++i) levels[0].emplace_back(float(i), 2, 0.5F);
  levels[1].assign(6, Rgb(1, 1, 1));
  const std::string bytes = ktx1_cube_bytes(2, levels, {{"sh", "1 2 3\n"}});
  EXPECT_EQ(bytes.substr(0, 12), std::string("\xABKTX 11\xBB\r\n\x1A\n", 12));
  const std::array<std::uint32_t, 13> header{0x04030201, 0x8C3B, 4, 0x1907, 0x8C3A, 0x1907, 2, 2, 0, 0, 6, 2, 16};
  for (std::size_t i = 0; i < header.size(); ++i) EXPECT_EQ(number_at(bytes, 12 + 4 * i, 4), header[i]) << i;
  EXPECT_EQ(number_at(bytes, 64, 4), 10U);  // "sh", NUL, six characters, NUL
  EXPECT_EQ(bytes.substr(68, 10), std::string("sh\0001 2 3\n\0", 10));
  EXPECT_EQ(number_at(bytes, 80, 4), 16U);  // bytes of a face
  EXPECT_EQ(number_at(bytes, 84 + 4 * 24, 4), 4U);
  EXPECT_EQ(bytes.size(), 84U + 96 + 4 + 24);
  const Rgb third = unpack_float11(std::uint32_t(number_at(bytes, 84 + 4 * 3, 4)));
  EXPECT_EQ(third, Rgb(3, 2, 0.5F));
}

// Against the formats' own arithmetic: half a step of the mantissa at most, and exact where a number is held as it is.
TEST(Texels, RoundToNearest) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> exponent(-12, 15);
  for (int i = 0; i < 20000; ++i) {
    const Rgb c(std::exp2(exponent(random)), std::exp2(exponent(random)), std::exp2(exponent(random)));
    const float most = std::max({c.x, c.y, c.z});
    const Rgb shared = unpack_shared_exponent(pack_shared_exponent(c));
    const Rgb eleven = unpack_float11(pack_float11(c));
    for (unsigned k = 0; k < 3; ++k) {
      // Nine bits of the largest channel: a step is 2^-8 of it at most.
      EXPECT_LE(std::abs(shared[k] - c[k]), most / 512 * 1.0001F);
      // Six or five bits and the hidden one; by way of halves, which may round twice.
      EXPECT_LE(std::abs(eleven[k] - c[k]), c[k] / (k < 2 ? 128 : 64) * 1.07F);
    }
  }
  EXPECT_EQ(unpack_shared_exponent(pack_shared_exponent(Rgb(1, 0.5F, 0))), Rgb(1, 0.5F, 0));
  EXPECT_EQ(unpack_shared_exponent(pack_shared_exponent(Rgb(1e9F, -1, 0))), Rgb(65408, 0, 0));
  EXPECT_EQ(unpack_shared_exponent(0), Rgb(0, 0, 0));
  EXPECT_EQ(pack_shared_exponent(Rgb(0, 0, 0)), 0U);
  // A mantissa that rounds up to 2^9 takes the next exponent.
  EXPECT_EQ(unpack_shared_exponent(pack_shared_exponent(Rgb(0.99999F, 0, 0))), Rgb(1, 0, 0));
  EXPECT_EQ(unpack_float11(pack_float11(Rgb(1e9F, -3, 1e9F))), Rgb(65024, 0, 64512));
  EXPECT_EQ(unpack_half(pack_half(1e9F)), 65504);
}

}  // namespace
}  // namespace ivory
