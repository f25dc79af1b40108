// OpenEXR files of other programs as environment maps: windows, layers, parts, primaries, values below zero.
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <ImfChannelList.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/io/environment.h"
#include "grid/io/picture/picture.h"
#include "grid/io/picture/primaries.h"
#include "tests/support/folder_test.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using Channels = std::map<std::string, float>;  // each of one value

class ExrPictures : public FolderTest {
 protected:
  std::string path(const std::string& name = "a.exr") const { return FolderTest::path(name); }

  static Imf::Header header(int width = 8, int height = 4) { return {width, height}; }

  // A picture of one part whose channel c holds values[c] + columns from the left of the data window / 100.
  std::string write(Imf::Header header, const Channels& values) const {
    const Imath::Box2i window = header.dataWindow();
    const int width = window.max.x - window.min.x + 1;
    const int height = window.max.y - window.min.y + 1;
    std::map<std::string, std::vector<float>> data;
    Imf::FrameBuffer buffer;
    for (const auto& [name, value] : values) {
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      std::vector<float>& plane = data[name];
      for (int i = 0; i < width * height; ++i) plane.push_back(value + 0.01F * float(i % width));
      buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, plane.data(), window));
    }
    fs::remove(path());
    Imf::OutputFile file(path().c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(height);
    return path();
  }

  static Rgb first(const LoadedEnvironment& loaded) {
    return std::get<EnvironmentMap>(loaded.image.map).radiance.front();
  }
  static std::vector<Rgb> texels(const LoadedEnvironment& loaded) {
    return std::get<EnvironmentMap>(loaded.image.map).radiance;
  }
  Rgb chosen(const Channels& values) const { return first(load_environment_image(write(header(), values))); }
  static std::string message(const std::string& file) {
    try {
      load_environment_image(file);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "";
  }
  // All in one line, for a look at what is said.
  static std::string warnings(const LoadedEnvironment& loaded) {
    std::string all;
    for (const std::string& warning : loaded.warnings) all += warning + " | ";
    return all;
  }
};

TEST_F(ExrPictures, ChannelsAreTakenByNameAndLayersByTheirs) {
  // In a file channels are sorted by name: Z after R, but B.Z before them, and AO before Combined.
  EXPECT_EQ(chosen({{"A", 1}, {"B", 3}, {"G", 2}, {"R", 1}, {"Z", 9}}), Rgb(1, 2, 3));
  EXPECT_EQ(chosen({{"B", 3}, {"G", 2}, {"R", 1}, {"AO.R", 7}, {"AO.G", 8}, {"AO.B", 9}}), Rgb(1, 2, 3));
  EXPECT_EQ(
      chosen({{"beauty.R", 1}, {"beauty.G", 2}, {"beauty.B", 3}, {"albedo.R", 7}, {"albedo.G", 8}, {"albedo.B", 9}}),
      Rgb(1, 2, 3));
  EXPECT_EQ(chosen({{"ViewLayer.Combined.R", 1},
                    {"ViewLayer.Combined.G", 2},
                    {"ViewLayer.Combined.B", 3},
                    {"ViewLayer.AO.R", 7},
                    {"ViewLayer.AO.G", 8},
                    {"ViewLayer.AO.B", 9},
                    {"ViewLayer.Normal.X", 7},
                    {"ViewLayer.Normal.Y", 8},
                    {"ViewLayer.Normal.Z", 9}}),
            Rgb(1, 2, 3));
  // Where there is one there is no doubt, whatever its name.
  const LoadedEnvironment lone =
      load_environment_image(write(header(), {{"sky.R", 1}, {"sky.G", 2}, {"sky.B", 3}, {"depth.Z", 5}}));
  EXPECT_EQ(first(lone), Rgb(1, 2, 3));
  EXPECT_TRUE(lone.warnings.empty()) << warnings(lone);
  EXPECT_EQ(std::get<std::string>(lone.facts.at("environment_layer")), "sky");
  // Blender's compositor stands before the layers that went into it.
  const LoadedEnvironment composite = load_environment_image(write(header(), {{"Composite.Combined.R", 1},
                                                                              {"Composite.Combined.G", 2},
                                                                              {"Composite.Combined.B", 3},
                                                                              {"ViewLayer.Combined.R", 7},
                                                                              {"ViewLayer.Combined.G", 8},
                                                                              {"ViewLayer.Combined.B", 9}}));
  EXPECT_EQ(first(composite), Rgb(1, 2, 3));
  EXPECT_NE(warnings(composite).find("'Composite.Combined' is taken, not 'ViewLayer.Combined'"), std::string::npos)
      << warnings(composite);
}

TEST_F(ExrPictures, WhatIsPlainlyNoPictureOrNotPlainlyOneIsRefused) {
  const auto refusal = [&](const Channels& values) { return message(write(header(), values)); };
  const std::string two =
      refusal({{"left.R", 1}, {"left.G", 2}, {"left.B", 3}, {"right.R", 7}, {"right.G", 8}, {"right.B", 9}});
  EXPECT_NE(two.find("'left', 'right'"), std::string::npos) << two;
  EXPECT_NE(refusal({{"a.Combined.R", 1},
                     {"a.Combined.G", 2},
                     {"a.Combined.B", 3},
                     {"b.Combined.R", 7},
                     {"b.Combined.G", 8},
                     {"b.Combined.B", 9}})
                .find("several layers"),
            std::string::npos);
  for (const Channels& values : std::vector<Channels>{{{"Z", 1}},
                                                      {{"A", 1}},
                                                      {{"X", 1}, {"Y", 2}, {"Z", 3}},
                                                      {{"R", 1}, {"G", 2}},
                                                      {{"N.X", 1}, {"N.Y", 2}, {"N.Z", 3}}})
    EXPECT_NE(refusal(values).find("neither R, G and B nor Y"), std::string::npos) << refusal(values);
}

TEST_F(ExrPictures, LuminanceIsGreyAndChromaIsColour) {
  EXPECT_EQ(chosen({{"Y", 3}, {"A", 1}}), Rgb(3, 3, 3));
  EXPECT_EQ(chosen({{"grey", 3}}), Rgb(3, 3, 3));
  constexpr int width = 64;
  {
    Imf::RgbaOutputFile file(path().c_str(), header(width, width / 2), Imf::WRITE_YC);
    const std::vector<Imf::Rgba> pixels(width * width / 2, Imf::Rgba(0.5F, 2, 1));
    file.setFrameBuffer(pixels.data(), 1, width);
    file.writePixels(width / 2);
  }
  // Chroma is kept in halves and rounded to fewer bits: 1 %.
  const Rgb color = texels(load_environment_image(path()))[width * width / 4 + width / 2];
  EXPECT_NEAR(color.x, 0.5, 0.01);
  EXPECT_NEAR(color.y, 2, 0.02);
  EXPECT_NEAR(color.z, 1, 0.01);
}

TEST_F(ExrPictures, PartsAreLayersToo) {
  const auto write_parts = [&](const std::vector<std::string>& names) {
    std::vector<Imf::Header> headers;
    for (const std::string& name : names) {
      headers.push_back(header());
      headers.back().setName(name);
      headers.back().setType(Imf::SCANLINEIMAGE);
      for (const char* channel : {"R", "G", "B"}) headers.back().channels().insert(channel, Imf::Channel(Imf::FLOAT));
    }
    fs::remove(path());
    Imf::MultiPartOutputFile file(path().c_str(), headers.data(), int(headers.size()));
    for (int i = 0; i < int(names.size()); ++i) {
      const std::vector<float> plane(32, float(i + 1));
      Imf::FrameBuffer buffer;
      for (const char* channel : {"R", "G", "B"})
        buffer.insert(channel, Imf::Slice::Make(Imf::FLOAT, plane.data(), headers[0].dataWindow()));
      Imf::OutputPart part(file, i);
      part.setFrameBuffer(buffer);
      part.writePixels(4);
    }
    return path();
  };
  const LoadedEnvironment loaded = load_environment_image(write_parts({"albedo", "beauty", "depth"}));
  EXPECT_EQ(first(loaded), Rgb(2, 2, 2));
  EXPECT_NE(warnings(loaded).find("'beauty' is taken, not 'albedo', 'depth'"), std::string::npos) << warnings(loaded);
  EXPECT_NE(message(write_parts({"left", "right"})).find("'left', 'right'"), std::string::npos);
}

TEST_F(ExrPictures, WindowsPlaceThePicture) {
  // Columns 2 to 5 and rows 1 to 2 of 8 x 4.
  Imf::Header cropped = header();
  cropped.dataWindow() = {{2, 1}, {5, 2}};
  const LoadedEnvironment crop = load_environment_image(write(cropped, {{"R", 1}, {"G", 1}, {"B", 1}}));
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 8; ++column) {
      const bool inside = row >= 1 && row <= 2 && column >= 2 && column <= 5;
      EXPECT_NEAR(texels(crop)[std::size_t(row * 8 + column)].x, inside ? 1 + 0.01 * (column - 2) : 0, 1e-6);
    }
  }
  EXPECT_NE(warnings(crop).find("covers 25 % of 8 x 4"), std::string::npos) << warnings(crop);

  Imf::Header wide = header();
  wide.dataWindow() = {{-2, -1}, {9, 4}};
  const LoadedEnvironment over = load_environment_image(write(wide, {{"R", 1}, {"G", 1}, {"B", 1}}));
  ASSERT_EQ(texels(over).size(), 32U);
  EXPECT_NEAR(first(over).x, 1.02, 1e-6);
  EXPECT_NE(warnings(over).find("overscan"), std::string::npos) << warnings(over);

  // The environment is the data window where the file says that it is one (ImfEnvmap.h).
  Imf::Header environment = header(100, 10);
  environment.dataWindow() = {{8, 4}, {15, 7}};
  Imf::addEnvmap(environment, Imf::ENVMAP_LATLONG);
  const LoadedEnvironment whole = load_environment_image(write(environment, {{"R", 1}, {"G", 1}, {"B", 1}}));
  EXPECT_EQ(texels(whole).size(), 32U);
  EXPECT_EQ(first(whole), Rgb(1, 1, 1));
  EXPECT_TRUE(whole.warnings.empty()) << warnings(whole);

  Imf::Header apart = header();
  apart.dataWindow() = {{20, 20}, {27, 23}};
  EXPECT_NE(message(write(apart, {{"R", 1}, {"G", 1}, {"B", 1}})).find("outside of its display window"),
            std::string::npos);
}

TEST_F(ExrPictures, ColoursComeToRec709) {
  // ACES' AP1 (S-2014-004) and what is known of it: white stays white, and luminance is
  // 0.2722 R + 0.6741 G + 0.0537 B under its own white, 0.66 of green's after adaptation to D65 within 2 %.
  Imf::Header ap1 = header();
  Imf::addChromaticities(
      ap1, Imf::Chromaticities({0.713F, 0.293F}, {0.165F, 0.830F}, {0.128F, 0.044F}, {0.32168F, 0.33767F}));
  const Rgb white = first(load_environment_image(write(ap1, {{"R", 1}, {"G", 1}, {"B", 1}})));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(white[c], 1, 1e-4);
  const LoadedEnvironment green = load_environment_image(write(ap1, {{"R", 0}, {"G", 1}, {"B", 0}}));
  EXPECT_NEAR(luminance(first(green)), 0.6741, 0.02 * 0.6741);
  // The matrix that ACEScg's implementations share: green is (-0.6217, 1.1408, -0.1290) of Rec.709, held at its edge.
  const V3d exact =
      transformed(to_rec709({{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}}), V3d(0, 1, 0));
  EXPECT_NEAR(exact.x, -0.6217, 1e-3);
  EXPECT_NEAR(exact.y, 1.1408, 1e-3);
  EXPECT_NEAR(exact.z, -0.1290, 1e-3);
  EXPECT_EQ(first(green).x, 0);
  EXPECT_NE(warnings(green).find("32 texels too saturated"), std::string::npos) << warnings(green);

  Imf::Header same = header();
  Imf::addChromaticities(same, Imf::Chromaticities());
  const LoadedEnvironment rec709 = load_environment_image(write(same, {{"R", 1}, {"G", 2}, {"B", 3}}));
  EXPECT_EQ(first(rec709), Rgb(1, 2, 3));
  EXPECT_TRUE(rec709.warnings.empty());

  // sRGB's profile, whose primaries are adapted to D50.
  Imf::Header profile = header();
  Imf::addChromaticities(
      profile, Imf::Chromaticities({0.6484F, 0.3309F}, {0.3212F, 0.5979F}, {0.1559F, 0.06606F}, {0.3457F, 0.3585F}));
  const LoadedEnvironment adapted = load_environment_image(write(profile, {{"R", 1}, {"G", 2}, {"B", 3}}));
  EXPECT_EQ(first(adapted), Rgb(1, 2, 3));
  EXPECT_TRUE(adapted.warnings.empty());

  Imf::Header bad = header();
  Imf::addChromaticities(bad, Imf::Chromaticities({0.3F, 0.3F}, {0.3F, 0.3F}, {0.3F, 0.3F}, {0.3F, 0.3F}));
  EXPECT_NE(message(write(bad, {{"R", 1}, {"G", 1}, {"B", 1}})).find("primaries"), std::string::npos);

  Imf::Header bright = header();
  Imf::addWhiteLuminance(bright, 100);
  const LoadedEnvironment nits = load_environment_image(write(bright, {{"R", 1}, {"G", 2}, {"B", 3}}));
  EXPECT_EQ(first(nits), Rgb(100, 200, 300));
  EXPECT_NE(warnings(nits).find("100 nits"), std::string::npos);
}

// One negative texel in a uniform map of 8 x 4: a column's eighth of the first row, 1 - cos(45 degrees) of half the
// sphere's 2.
TEST_F(ExrPictures, ValuesBelowZeroCountAsNothingWhileTheyAreFew) {
  const auto with_one = [&](float value) {
    std::vector<Rgb> map(32, Rgb(1, 1, 1));
    map[3] = Rgb(1, value, 1);
    Imf::Header h = header();
    Imf::FrameBuffer buffer;
    constexpr std::array<const char*, 3> names{"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
      h.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
      buffer.insert(names[c],
                    Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&map[0].x + c), sizeof(Rgb), 8 * sizeof(Rgb)));
    }
    fs::remove(path());
    Imf::OutputFile file(path().c_str(), h);
    file.setFrameBuffer(buffer);
    file.writePixels(4);
  };
  const double texel = (1 - std::sqrt(0.5)) / 2 / 8;  // of the sphere
  const double all = 3 - texel;                       // of three channels, without what is below zero
  with_one(-0.5F);
  const LoadedEnvironment loaded = load_environment_image(path());
  EXPECT_EQ(texels(loaded)[3], Rgb(1, 0, 1));
  EXPECT_NE(warnings(loaded).find(fmt::format("1 texel below zero, {:.2g} % of the light", 100 * 0.5 * texel / all)),
            std::string::npos)
      << warnings(loaded);
  with_one(float(-0.99 * 0.01 * all / texel));
  EXPECT_EQ(message(path()), "");
  with_one(float(-1.01 * 0.01 * all / texel));
  EXPECT_NE(message(path()).find("below zero in 1 texel, 1.01 %"), std::string::npos) << message(path());
}

// CC0 maps, some with a few values below zero from their compression.
TEST(BlendersMaps, AreRead) {
  const fs::path folder = "/usr/share/blender/datafiles/studiolights/world";
  if (!fs::exists(folder)) GTEST_SKIP() << "needs Debian's package blender-data";
  int seen = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".exr") continue;
    EXPECT_NO_THROW(load_environment_image(entry.path().string())) << entry.path();
    ++seen;
  }
  EXPECT_GE(seen, 8);
}

}  // namespace
}  // namespace ivory
