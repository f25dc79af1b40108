// Radiance files: every order of lines, exposure, colour format, both ways of packing, damage.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/io/environment.h"
#include "tests/support/folder_test.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

class RadianceFiles : public FolderTest {
 protected:
  std::string write(const std::string& bytes) const {
    const std::string file = path("a.hdr");
    fs::remove(file);
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  }
  std::string message(const std::string& bytes) const {
    try {
      load_environment_image(write(bytes));
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "";
  }
};

std::string header(const std::string& entries, const std::string& resolution) {
  return "#?RADIANCE\n" + entries + "\n" + resolution + "\n";
}
const std::string rgbe = "FORMAT=32-bit_rle_rgbe\n";

// With exponent 136 a byte is its own value.
std::string pixel(int r, int g, int b, int e = 136) { return {char(r), char(g), char(b), char(e)}; }

// What stands at a place of an 8 x 4 map.
Rgb shown(int column, int row) { return Rgb(float(10 + column), float(50 + row), float(100 + 8 * row + column)); }

std::vector<Rgb> texels(const LoadedEnvironment& loaded) { return std::get<EnvironmentMap>(loaded.image.map).radiance; }

// Flat pixels in the order that the resolution line says, by Radiance's own words: lines run along the axis that
// comes last, X counts to the right, Y upwards.
TEST_F(RadianceFiles, LinesMayLieInAllEightOrders) {
  constexpr int width = 8;
  constexpr int height = 4;
  int seen = 0;
  for (const bool y_first : {true, false}) {
    for (const char y_sign : {'-', '+'}) {
      for (const char x_sign : {'+', '-'}) {
        const std::string y = std::string(1, y_sign) + "Y 4";
        const std::string x = std::string(1, x_sign) + "X 8";
        std::string bytes = header(rgbe, y_first ? y + " " + x : x + " " + y);
        const auto put = [&](int i, int j) {  // the i-th along x and the j-th along y
          const Rgb v = shown(x_sign == '+' ? i : width - 1 - i, y_sign == '-' ? j : height - 1 - j);
          bytes += pixel(int(v.x), int(v.y), int(v.z));
        };
        if (y_first) {
          for (int j = 0; j < height; ++j)
            for (int i = 0; i < width; ++i) put(i, j);
        } else {
          for (int i = 0; i < width; ++i)
            for (int j = 0; j < height; ++j) put(i, j);
        }
        const LoadedEnvironment loaded = load_environment_image(write(bytes));
        EXPECT_TRUE(loaded.warnings.empty());
        const std::vector<Rgb> read = texels(loaded);
        ASSERT_EQ(read.size(), 32U);
        for (int row = 0; row < height; ++row)
          for (int column = 0; column < width; ++column)
            EXPECT_EQ(read[std::size_t(row * width + column)], shown(column, row)) << y << x << y_first;
        ++seen;
      }
    }
  }
  EXPECT_EQ(seen, 8);
}

TEST_F(RadianceFiles, ValuesAreDividedByAllExposures) {
  const std::string pixels = pixel(80, 160, 240) + pixel(8, 16, 24);
  const std::string entries = "EXPOSURE=2\n# EXPOSURE=9\nEXPOSURE= 4.0 \n\tEXPOSURE=100\nCOLORCORR=1 2 5\n" + rgbe;
  const LoadedEnvironment loaded = load_environment_image(write(header(entries, "-Y 1 +X 2") + pixels));
  EXPECT_EQ(texels(loaded), (std::vector<Rgb>{Rgb(10, 10, 6), Rgb(1, 1, 0.6F)}));
  ASSERT_EQ(loaded.warnings.size(), 1U);
  EXPECT_NE(loaded.warnings[0].find("8 16 40"), std::string::npos) << loaded.warnings[0];
  EXPECT_NE(message(header("EXPOSURE=0\n" + rgbe, "-Y 1 +X 2") + pixels).find("EXPOSURE"), std::string::npos);
  EXPECT_NE(message(header("EXPOSURE=nan\n" + rgbe, "-Y 1 +X 2") + pixels).find("EXPOSURE"), std::string::npos);
  EXPECT_NE(message(header("COLORCORR=1 2\n" + rgbe, "-Y 1 +X 2") + pixels).find("COLORCORR"), std::string::npos);
}

// X, Y, Z of Rec.709's white and green (IEC 61966-2-1), to the eight bits that they are stored in.
TEST_F(RadianceFiles, XyzBecomesRec709) {
  const double scale = 255 / 1.089;
  const auto xyz = [&](double x, double y, double z) {
    return pixel(int(std::lround(x * scale)), int(std::lround(y * scale)), int(std::lround(z * scale)));
  };
  const LoadedEnvironment loaded = load_environment_image(
      write(header("FORMAT=32-bit_rle_xyze\n", "-Y 1 +X 2") + xyz(0.9505, 1, 1.089) + xyz(0.3576, 0.7152, 0.1192)));
  const std::vector<Rgb> read = texels(loaded);
  for (int c = 0; c < 3; ++c) {
    // Half a step of 255 is 0.002; the matrix makes up to 5.5 times as much of it.
    EXPECT_NEAR(read[0][c] / scale, 1, 0.012);
    EXPECT_NEAR(read[1][c] / scale, c == 1 ? 1 : 0, 0.012);
  }
  EXPECT_EQ(loaded.warnings.size(), 1U);
  EXPECT_NE(message(header("FORMAT=32-bit_rle_lab\n", "-Y 1 +X 2") + pixel(9, 9, 9) + pixel(9, 9, 9)).find("lab"),
            std::string::npos);
}

// Photoshop's eight zeros say nothing; primaries of Rec.709 with Radiance's even white are other ones, white stays
// white.
TEST_F(RadianceFiles, PrimariesAreTakenWhereTheyAreSaid) {
  const std::string pixels = pixel(80, 80, 80) + pixel(9, 80, 9);
  const auto read = [&](const std::string& primaries) {
    return load_environment_image(write(header("GAMMA=1\nPRIMARIES=" + primaries + "\n" + rgbe, "-Y 1 +X 2") + pixels));
  };
  const LoadedEnvironment unknown = read("0 0 0 0 0 0 0 0");
  EXPECT_EQ(texels(unknown), (std::vector<Rgb>{Rgb(80, 80, 80), Rgb(9, 80, 9)}));
  EXPECT_TRUE(unknown.warnings.empty());
  const LoadedEnvironment even = read(".640 .330 .290 .600 .150 .060 .3333 .3333");
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(texels(even)[0][c], 80, 1e-2);
  EXPECT_NE(texels(even)[1], Rgb(9, 80, 9));
  EXPECT_EQ(even.warnings.size(), 1U);
  EXPECT_THROW(read("0.3 0.3 0.3 0.3 0.3 0.3 0.3 0.3"), Error);
}

TEST_F(RadianceFiles, OldRunsAreReadInTheirPlace) {
  // A pixel; 300 more of it as 44 + 256; one of its own; 210 more: 512 of a line.
  const std::string line =
      pixel(5, 6, 7) + pixel(1, 1, 1, 44) + pixel(1, 1, 1, 1) + pixel(50, 60, 70) + pixel(1, 1, 1, 210);
  std::string bytes = header(rgbe, "-Y 256 +X 512");
  for (int row = 0; row < 256; ++row) bytes += line;
  const std::vector<Rgb> read = texels(load_environment_image(write(bytes)));
  for (std::size_t row = 0; row < 256; row += 255) {
    EXPECT_EQ(read[row * 512], Rgb(5, 6, 7));
    EXPECT_EQ(read[row * 512 + 300], Rgb(5, 6, 7));
    EXPECT_EQ(read[row * 512 + 301], Rgb(50, 60, 70));
    EXPECT_EQ(read[row * 512 + 511], Rgb(50, 60, 70));
  }
  EXPECT_NE(message(header(rgbe, "-Y 1 +X 2") + pixel(1, 1, 1, 2)).find("damaged"), std::string::npos);
  EXPECT_NE(message(header(rgbe, "-Y 1 +X 2") + pixel(9, 9, 9) + pixel(1, 1, 1, 2)).find("damaged"), std::string::npos);
}

// What OpenImageIO writes, packed by component, and reads.
TEST_F(RadianceFiles, NewRunsAreReadAsOpenImageIoReadsThem) {
  constexpr int width = 64;
  std::vector<Rgb> film;
  for (int i = 0; i < width * width / 2; ++i)
    film.emplace_back(float(i % 7), i < 700 ? 3.25F : 1e-3F * float(i), std::ldexp(1.0F, i % 40 - 20));
  const std::string file = path("a.hdr");
  auto output = OIIO::ImageOutput::create(file);
  ASSERT_TRUE(output->open(file, OIIO::ImageSpec(width, width / 2, 3, OIIO::TypeDesc::FLOAT)));
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, film.data()) && output->close());
  std::vector<Rgb> twin(film.size());
  ASSERT_TRUE(OIIO::ImageInput::open(file)->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, twin.data()));
  EXPECT_EQ(texels(load_environment_image(file)), twin);
  // Cut anywhere it is refused.
  std::ifstream in(file, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  for (std::size_t keep = 2; keep < whole.size(); keep += 97) EXPECT_NE(message(whole.substr(0, keep)), "") << keep;
}

TEST_F(RadianceFiles, HeadersThatSayNoPictureAreRefused) {
  for (const char* resolution :
       {"", "-Y 1", "-Y 1 +Y 2", "-Y 1 +Z 2", "-Y 0 +X 2", "-Y 1 +X 99999999", "-Y -1 +X 2", "+X"})
    EXPECT_NE(message(header(rgbe, resolution) + std::string(64, 'x')), "") << resolution;
  EXPECT_NE(message("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"), "");
  EXPECT_NE(message(header(rgbe, "-Y 30000 +X 60000") + std::string(64, 'x')).find("claims"), std::string::npos);
  EXPECT_NE(message("#?"), "");
}

}  // namespace
}  // namespace ivory
