// One picture in every format is one light; what a file does not say is assumed with a word.
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <webp/encode.h>
#include <zlib.h>

#include "grid/base/error.h"
#include "grid/io/environment.h"
#include "grid/io/picture/primaries.h"
#include "grid/io/picture/scan_order.h"
#include "tests/support/folder_test.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr int width = 8;
constexpr int height = 4;

class Pictures : public FolderTest {
 protected:
  // `values` of 8 bits each, stored as `type`.
  std::string write(const std::string& name, int channels, const std::vector<std::uint8_t>& values, TypeDesc type,
                    const std::function<void(ImageSpec&)>& edit = {}) const {
    ImageSpec spec(width, height, channels, type);
    if (channels == 4) spec.attribute("oiio:UnassociatedAlpha", 1);
    if (edit) edit(spec);
    const auto output = OIIO::ImageOutput::create(path(name));
    EXPECT_TRUE(output && output->open(path(name), spec) && output->write_image(TypeDesc::UINT8, values.data()) &&
                output->close())
        << name;
    return path(name);
  }
  std::string write_webp(const std::string& name, const std::vector<std::uint8_t>& rgba) const {
    std::uint8_t* bytes = nullptr;
    const std::size_t size = WebPEncodeLosslessRGBA(rgba.data(), width, height, 4 * width, &bytes);
    std::ofstream(path(name), std::ios::binary).write(reinterpret_cast<const char*>(bytes), std::streamsize(size));
    WebPFree(bytes);
    return path(name);
  }
  static std::vector<Rgb> texels(const LoadedEnvironment& loaded) {
    return std::get<EnvironmentMap>(loaded.image.map).radiance;
  }
  static bool warns(const LoadedEnvironment& loaded, const std::string& part) {
    for (const std::string& warning : loaded.warnings)
      if (warning.find(part) != std::string::npos) return true;
    return false;
  }
};

std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Every texel another colour, none of them grey.
std::vector<std::uint8_t> colors(int channels, int alpha = 255) {
  std::vector<std::uint8_t> out;
  for (int i = 0; i < width * height; ++i)
    for (int c = 0; c < channels; ++c) out.push_back(std::uint8_t(c == 3 ? alpha : (i * 7 + c * 60) % 256));
  return out;
}

// Numbers of 32 bits as PNG keeps them, and one of its chunks.
std::string words(std::initializer_list<unsigned> values) {
  std::string out;
  for (const unsigned value : values)
    for (int shift = 24; shift >= 0; shift -= 8) out += char(value >> unsigned(shift));
  return out;
}
std::string chunk(const std::string& type, const std::string& data) {
  const std::string whole = type + data;
  return words({unsigned(data.size())}) + whole +
         words({unsigned(crc32(0, reinterpret_cast<const Bytef*>(whole.data()), uInt(whole.size())))});
}

// IEC 61966-2-1.
float linear(int byte) {
  const double x = byte / 255.0;
  return float(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

void expect_srgb(const std::vector<Rgb>& read, const std::string& name) {
  const std::vector<std::uint8_t> rgb = colors(3);
  ASSERT_EQ(read.size(), std::size_t(width * height)) << name;
  for (std::size_t i = 0; i < read.size(); ++i)
    for (unsigned c = 0; c < 3; ++c) EXPECT_NEAR(read[i][c], linear(rgb[i * 3 + c]), 1e-6) << name << i;
}

TEST_F(Pictures, OnePictureIsOneLightInEveryFormat) {
  const std::vector<std::uint8_t> rgb = colors(3);
  for (const char* name : {"a.png", "a.bmp", "a.tga", "a.tif", "a.ppm", "a.sgi"})
    expect_srgb(texels(load_environment_image(write(name, 3, rgb, TypeDesc::UINT8))), name);
  for (const char* name : {"deep.png", "deep.tif"})
    expect_srgb(texels(load_environment_image(write(name, 3, rgb, TypeDesc::UINT16))), name);
  expect_srgb(texels(load_environment_image(write_webp("a.webp", colors(4)))), "a.webp");
  // JPEG rounds colours: one of the same everywhere, to a step or two of 255.
  const std::vector<std::uint8_t> even(width * height * 3, 180);
  const LoadedEnvironment jpeg = load_environment_image(write("a.jpg", 3, even, TypeDesc::UINT8));
  EXPECT_NEAR(texels(jpeg)[9].y, linear(180), 0.02);

  // Floats are linear.
  for (const char* name : {"float.tif", "float.exr"}) {
    const LoadedEnvironment loaded = load_environment_image(write(name, 3, rgb, TypeDesc::FLOAT));
    EXPECT_NEAR(texels(loaded)[3].y, float(rgb[10]) / 255, 1e-6);
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
    EXPECT_TRUE(loaded.facts.empty());
  }

  // What says nothing is said; PNG and WebP are sRGB by their own standards.
  for (const char* name : {"a.bmp", "a.tga", "a.tif", "deep.tif"}) {
    const LoadedEnvironment loaded = load_environment_image(path(name));
    EXPECT_TRUE(warns(loaded, "sRGB is assumed")) << name;
    EXPECT_EQ(std::get<std::string>(loaded.facts.at("environment_color_space")), "sRGB Rec.709");
  }
  EXPECT_TRUE(load_environment_image(path("a.png")).warnings.empty());
  EXPECT_TRUE(load_environment_image(path("a.webp")).warnings.empty());
}

TEST_F(Pictures, PowersThatFilesStateAreTaken) {
  const std::vector<std::uint8_t> rgb = colors(3);
  for (const double gamma : {1.8, 2.2}) {
    const std::string space = gamma == 2.2 ? "Gamma2.2" : "Gamma1.8";
    for (const char* name : {"a.png", "a.tga"}) {
      const LoadedEnvironment loaded =
          load_environment_image(write(name, 3, rgb, TypeDesc::UINT8, [&](ImageSpec& spec) {
            spec.attribute("oiio:ColorSpace", name == std::string("a.png") ? space : "GammaCorrected");
            spec.attribute("oiio:Gamma", float(gamma));
          }));
      // PNG keeps five decimals of 1 / gamma.
      for (std::size_t i = 0; i < rgb.size(); ++i)
        EXPECT_NEAR(texels(loaded)[i / 3][unsigned(i % 3)], std::pow(rgb[i] / 255.0, gamma), 1e-4) << name << space;
      EXPECT_TRUE(warns(loaded, "power of")) << name;
    }
  }
  const LoadedEnvironment flat = load_environment_image(write(
      "flat.png", 3, rgb, TypeDesc::UINT8, [&](ImageSpec& spec) { spec.attribute("oiio:ColorSpace", "linear"); }));
  EXPECT_NEAR(texels(flat)[3].y, float(rgb[10]) / 255, 1e-6);
  // cHRM of Display P3, whose green is (-0.2249, 1.0421, -0.0786) of Rec.709 (the published matrix), at a grey and at
  // its green with sRGB's curve.
  std::string png = bytes_of(write("p3.png", 3, std::vector<std::uint8_t>(96, 180), TypeDesc::UINT8));
  png.insert(33, chunk("cHRM", words({31270, 32900, 68000, 32000, 26500, 69000, 15000, 6000})));
  while (png.find("sRGB") != std::string::npos) png.replace(png.find("sRGB") - 4, 13, "");
  std::ofstream(path("p3_grey.png"), std::ios::binary) << png;
  const LoadedEnvironment p3 = load_environment_image(path("p3_grey.png"));
  for (unsigned c = 0; c < 3; ++c) EXPECT_NEAR(texels(p3)[5][c], linear(180), 1e-4);
  EXPECT_TRUE(warns(p3, "from primaries 0.68,0.32"));
  const V3d green = transformed(to_rec709({{0.68, 0.32}, {0.265, 0.69}, {0.15, 0.06}, {0.3127, 0.3290}}), V3d(0, 1, 0));
  EXPECT_NEAR(green.x, -0.2249, 1e-3);
  EXPECT_NEAR(green.y, 1.0421, 1e-3);
  EXPECT_NEAR(green.z, -0.0786, 1e-3);
  const std::string log = write("log.dpx", 3, rgb, TypeDesc::UINT16,
                                [](ImageSpec& spec) { spec.attribute("oiio:ColorSpace", "KodakLog"); });
  EXPECT_THROW(load_environment_image(log), Error);
}

// At an alpha of 16 / 255 a sixteenth of the colour would be left, and none at 0.
TEST_F(Pictures, ColourBehindAlphaCountsInFull) {
  for (const int alpha : {16, 254}) {
    const std::vector<std::uint8_t> rgba = colors(4, alpha);
    for (const char* name : {"a.png", "a.tga", "a.tif", "a.bmp"}) {
      const LoadedEnvironment loaded = load_environment_image(write(name, 4, rgba, TypeDesc::UINT8));
      expect_srgb(texels(loaded), name);
      EXPECT_TRUE(warns(loaded, "alpha below 1 in 32 of 32 texels")) << name;
    }
    const LoadedEnvironment webp = load_environment_image(write_webp("a.webp", rgba));
    expect_srgb(texels(webp), "a.webp");
    EXPECT_TRUE(warns(webp, "alpha below 1 in 32 of 32 texels"));
  }
  // Colour stored times alpha, half of it, is colour again to a step of 255.
  std::vector<std::uint8_t> associated = colors(4, 128);
  for (std::size_t i = 0; i < associated.size(); ++i)
    if (i % 4 != 3) associated[i] = std::uint8_t(std::lround(associated[i] * 128 / 255.0));
  const LoadedEnvironment tif =
      load_environment_image(write("times.tif", 4, associated, TypeDesc::UINT8,
                                   [](ImageSpec& spec) { spec.erase_attribute("oiio:UnassociatedAlpha"); }));
  for (std::size_t i = 0; i < texels(tif).size(); ++i)
    EXPECT_NEAR(texels(tif)[i].x, linear(colors(3)[i * 3]), 0.011) << i;
}

// A grey PNG of that size around other rows than it should have.
std::string png_around(unsigned png_width, unsigned png_height, const std::string& rows) {
  std::string packed(rows.size() + 100, '\0');
  uLongf size = packed.size();
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(rows.data()),
                     uLong(rows.size())),
            Z_OK);
  packed.resize(size);
  return "\x89PNG\r\n\x1A\n" + chunk("IHDR", words({png_width, png_height}) + std::string("\x08\0\0\0\0", 5)) +
         chunk("IDAT", packed) + chunk("IEND", "");
}

// Found by fuzzing: what libpng says has an end of line; a header of 80 bytes took gigabytes before it was found out.
TEST_F(Pictures, DamageIsOneLineAndTakesNoMemory) {
  const auto message = [&](const std::string& bytes) -> std::string {
    std::ofstream(path("a.png"), std::ios::binary) << bytes;
    try {
      load_environment_image(path("a.png"));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const std::string filter = message(png_around(4, 2, std::string("\x09\1\2\3\4\x09\1\2\3\4", 10)));
  EXPECT_NE(filter.find("is damaged"), std::string::npos) << filter;
  EXPECT_EQ(filter.find('\n'), std::string::npos) << filter;
  const std::string claim = message(png_around(32000, 16000, std::string(20, '\0')));
  EXPECT_NE(claim.find("claims 32000 x 16000 pixels"), std::string::npos) << claim;
}

TEST_F(Pictures, OrientationsAreUpright) {
  const std::vector<std::uint8_t> rgb = colors(3);
  std::vector<Rgb> stored;
  for (std::size_t i = 0; i < rgb.size(); i += 3)
    stored.emplace_back(linear(rgb[i]), linear(rgb[i + 1]), linear(rgb[i + 2]));
  const auto at = [&](int row, int column) { return stored[std::size_t(row * width + column)]; };
  const auto read = [&](int orientation) {
    return texels(load_environment_image(
        write("a.tif", 3, rgb, TypeDesc::UINT8, [&](ImageSpec& spec) { spec.attribute("Orientation", orientation); })));
  };
  // TIFF 6.0: the first row is seen at the bottom, the first column at the right.
  EXPECT_NEAR(read(3)[0].x, at(height - 1, width - 1).x, 1e-6);
  EXPECT_NEAR(read(2)[0].x, at(0, width - 1).x, 1e-6);
  EXPECT_NEAR(read(4)[0].x, at(height - 1, 0).x, 1e-6);
  // Of those with rows as columns the first row is at the left, right, right, left, the first column at the top, top,
  // bottom, bottom. A strip of 1 x 6 faces that lies becomes one that stands.
  std::vector<Rgb> strip{Rgb(0, 0, 0), Rgb(1, 1, 1), Rgb(2, 2, 2), Rgb(3, 3, 3), Rgb(4, 4, 4), Rgb(5, 5, 5)};
  const auto turned = [&](int orientation) { return upright(strip, 2, 3, *scan_order_of_exif(orientation)); };
  const auto values = [](const std::vector<Rgb>& picture) {
    std::string text;
    for (const Rgb& t : picture) text += char('0' + int(t.x));
    return text;
  };
  // Stored as 012 / 345.
  EXPECT_EQ(values(turned(5)), "031425");
  EXPECT_EQ(values(turned(6)), "304152");
  EXPECT_EQ(values(turned(7)), "524130");
  EXPECT_EQ(values(turned(8)), "251403");
  EXPECT_FALSE(scan_order_of_exif(0));
  EXPECT_FALSE(scan_order_of_exif(9));
}

}  // namespace
}  // namespace ivory
