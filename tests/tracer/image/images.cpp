// Cameras, films, image files and their comparison.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/env/latlong_map.h"
#include "grid/io/environment.h"
#include "tests/support/folder_test.h"
#include "tests/support/full_disk.h"
#include "tests/support/paths.h"
#include "tracer/core/camera.h"
#include "tracer/image/compare.h"
#include "tracer/image/file.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

class Images : public FolderTest {
 protected:
  std::size_t file_count() const {
    return std::size_t(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
};

Film make_film(int width, int height) {
  Film film;
  film.width = width;
  film.height = height;
  for (int i = 0; i < width * height; ++i)
    film.pixels.push_back(Rgb(0.1F * float(i), 1e-3F + float(i) * float(i), 1e5F / float(i + 1)));
  return film;
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

TEST(Camera, LooksAlongMinusZ) {
  Camera camera;
  camera.yfov_rad = pi / 2;
  camera.to_world.setTranslation(V3f(1, 2, 3));
  const View view = make_view("test", camera, 200, 100);
  const Ray centre = make_ray(view, {100, 50});
  EXPECT_EQ(centre.origin, V3f(1, 2, 3));
  EXPECT_LT((centre.direction - V3f(0, 0, -1)).length(), 1e-6F);
  EXPECT_TRUE(centre.cull_back_faces);
  // 45 degrees up at the top edge; twice as far to the right at twice the width.
  EXPECT_LT((make_ray(view, {100, 0}).direction - V3f(0, 1, -1).normalized()).length(), 1e-6F);
  EXPECT_LT((make_ray(view, {200, 50}).direction - V3f(2, 0, -1).normalized()).length(), 1e-6F);
}

TEST(Camera, IgnoresScaleAndFollowsRotation) {
  Camera camera;
  // Turned to look along -X: local -Z to world -X, local X to world -Z. Scaled by 7.
  camera.to_world = M44f(0, 0, -7, 0, 0, 7, 0, 0, 7, 0, 0, 0, 0, 0, 0, 1);
  const View view = make_view("test", camera, 100, 100);
  EXPECT_LT((make_ray(view, {50, 50}).direction - V3f(-1, 0, 0)).length(), 1e-6F);
  EXPECT_LT(make_ray(view, {100, 50}).direction.z, 0);
  EXPECT_NEAR(make_ray(view, {50, 0}).direction.y, std::sin(0.4F), 1e-6F);  // half the default angle
}

TEST(Camera, Orthographic) {
  Camera camera;
  camera.perspective = false;
  camera.ymag_m = 3;
  const View view = make_view("test", camera, 200, 100);
  const Ray corner = make_ray(view, {200, 0});
  EXPECT_LT((corner.origin - V3f(6, 3, 0)).length(), 1e-5F);
  EXPECT_EQ(corner.direction, V3f(0, 0, -1));
}

TEST(Camera, FramesTheWholeSphere) {
  for (const float aspect : {0.5F, 1.0F, 2.0F}) {
    const V3f center(1, 2, 3);
    const View view = make_view("test", framing_camera(center, 5, aspect), int(100 * aspect), 100);
    EXPECT_LT((make_ray(view, {50 * aspect, 50}).direction - (center - view.origin).normalized()).length(), 1e-5F);
    // Rays through the middles of the four edges pass the sphere without entering it by more than rounding.
    for (const V2f& edge : {V2f(0, 50), V2f(100 * aspect, 50), V2f(50 * aspect, 0), V2f(50 * aspect, 100)}) {
      const Ray ray = make_ray(view, edge);
      const V3f d = center - ray.origin;
      EXPECT_GT(d.cross(ray.direction).length(), 5 - 1e-3F);
    }
  }
}

TEST(Camera, RefusesWhatMakesNoPicture) {
  Camera camera;
  camera.yfov_rad = 0;
  EXPECT_THROW(make_view("test", camera, 1, 1), Error);
  camera = Camera{};
  camera.to_world.setScale(V3f(0, 1, 1));
  EXPECT_THROW(make_view("test", camera, 1, 1), Error);
  Scene scene;
  scene.cameras.resize(2);
  scene.cameras[1].name = "main";
  EXPECT_EQ(&find_camera(scene, "main"), &scene.cameras[1]);
  EXPECT_EQ(&find_camera(scene, "0"), &scene.cameras[0]);
  EXPECT_THROW(find_camera(scene, "2"), ParameterError);
  EXPECT_THROW(find_camera(scene, "0x"), ParameterError);
  EXPECT_THROW(find_camera(scene, "-1"), ParameterError);
}

TEST_F(Images, ExrKeepsEveryBit) {
  const Film film = make_film(7, 5);
  write_image(path("a.exr"), film, 3, {{"method", std::string("path")}, {"seed", std::int64_t(1) << 40}}, false);
  const Film back = read_image(path("a.exr"));
  EXPECT_EQ(back.width, 7);
  EXPECT_EQ(back.height, 5);
  EXPECT_EQ(back.pixels, film.pixels);
  write_image(path("b.exr"), film, 3, {{"method", std::string("path")}, {"seed", std::int64_t(1) << 40}}, false);
  EXPECT_EQ(bytes_of(path("a.exr")), bytes_of(path("b.exr")));
}

TEST_F(Images, PngIsToneMappedSrgb) {
  Film film;
  film.width = 3;
  film.height = 1;
  // Below the tone mapper's toe nothing but its fixed offset is taken: 0.25 - 0.04.
  film.pixels = {Rgb(0, 0, 0), Rgb(0.0625F, 0.0625F, 0.0625F), Rgb(1e6F, 1e6F, 1e6F)};
  write_image(path("a.png"), film, 2, {}, false);
  const Film back = read_image(path("a.png"));
  EXPECT_EQ(back.pixels[0].x, 0);
  const double srgb = 1.055 * std::pow(0.21, 1 / 2.4) - 0.055;
  EXPECT_NEAR(back.pixels[1].x, srgb, 0.5 / 255 + 1e-6);
  EXPECT_EQ(back.pixels[2].x, 1);
}

TEST_F(Images, AreWrittenWholeOrNotAtAll) {
  const Film film = make_film(2, 2);
  write_image(path("a.exr"), film, 0, {}, false);
  EXPECT_THROW(write_image(path("a.exr"), film, 0, {}, false), Error);
  EXPECT_NO_THROW(write_image(path("a.exr"), film, 0, {}, true));
  EXPECT_THROW(write_image(path("a.nonsense"), film, 0, {}, false), Error);
  EXPECT_THROW(write_image(path("no_extension"), film, 0, {}, false), Error);
  EXPECT_THROW(write_image(path("missing/a.exr"), film, 0, {}, false), Error);
  EXPECT_EQ(file_count(), 1U);  // nothing temporary is left
}

// Whatever it is called.
TEST_F(Images, MayasIffIsRefused) {
  EXPECT_THROW(write_display_image(path("a.iff"), {4, 2, std::vector<std::uint8_t>(24, 100)}, {}, false), Error);
  for (const char* name : {"a.iff", "a.exr"}) {
    std::ofstream(path(name)) << "FOR4" << std::string(64, '\0');
    try {
      load_environment(path(name));
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("Maya IFF"), std::string::npos) << error.what();
    }
  }
}

// A disk that is full in the middle of a picture: an error, the old file as it was, and nothing beside it.
TEST_F(Images, AFullDiskIsAnErrorInEveryFormat) {
  Film film = make_film(64, 64);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(0, 2);  // hard to pack
  for (Rgb& pixel : film.pixels) pixel = Rgb(value(random), value(random), value(random));
  DisplayImage display{64, 64, {}};
  for (const Rgb& p : film.pixels)
    for (int c = 0; c < 3; ++c) display.rgb.push_back(std::uint8_t(p[c] * 127));
  std::size_t count = 0;
  for (const char* extension : {"exr", "hdr", "tif", "png", "jpg", "tga", "bmp", "gif", "webp", "ppm", "dpx", "jp2"}) {
    const std::string file = path(std::string("a.") + extension);
    const bool linear = is_linear_image(file);
    const auto write = [&](bool force) {
      if (linear)
        write_image(file, film, 0, {}, force);
      else
        write_display_image(file, display, {}, force);
    };
    write(false);
    ++count;
    const std::string whole = bytes_of(file);
    ASSERT_GT(whole.size(), 1000U) << extension;
    for (const std::size_t room : {std::size_t(0), std::size_t(1), whole.size() / 2, whole.size() - 1}) {
      const FullDisk full(room);
      try {
        write(true);
        ADD_FAILURE() << extension << " with room for " << room;
      } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("File too large"), std::string::npos) << error.what();
      }
      EXPECT_EQ(bytes_of(file), whole) << extension;
      EXPECT_EQ(file_count(), count) << extension;
    }
    const FullDisk enough(whole.size());
    write(true);
    EXPECT_EQ(bytes_of(file), whole) << extension;
  }
  // Formats that only write to files, and one that writes nothing.
  for (const char* name : {"a.sgi", "a.ico", "a.rla", "a.fits", "a.null"}) {
    EXPECT_THROW(write_image(path(name), film, 0, {}, false), Error) << name;
    EXPECT_FALSE(fs::exists(path(name)));
  }
}

TEST_F(Images, BadFilesAreRefused) {
  EXPECT_THROW(read_image(path("missing.exr")), Error);
  std::ofstream(path("text.exr")) << "not an image";
  EXPECT_THROW(read_image(path("text.exr")), Error);
  write_image(path("a.exr"), make_film(64, 64), 0, {}, false);
  const std::string whole = bytes_of(path("a.exr"));
  std::ofstream(path("cut.exr"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  EXPECT_THROW(read_image(path("cut.exr")), Error);
  EXPECT_THROW(load_environment(path("cut.exr")), Error);
  Film nan = make_film(2, 2);
  nan.pixels[1].y = std::numeric_limits<float>::quiet_NaN();
  write_image(path("nan.exr"), nan, 0, {}, false);
  EXPECT_THROW(read_image(path("nan.exr")), Error);
}

TEST_F(Images, EnvironmentsAreLatLongFiniteAndNotNegative) {
  Film film = make_film(8, 4);
  write_image(path("good.exr"), film, 0, {}, false);
  const EnvironmentMap map = load_environment(path("good.exr"));
  EXPECT_EQ(map.width, 8);
  EXPECT_EQ(map.radiance, film.pixels);
  write_image(path("shapeless.exr"), make_film(5, 4), 0, {}, false);
  EXPECT_THROW(load_environment(path("shapeless.exr")), Error);
  film.pixels[3].x = -1e6F;
  write_image(path("negative.exr"), film, 0, {}, false);
  EXPECT_THROW(load_environment(path("negative.exr")), Error);
  film.pixels[3].x = std::numeric_limits<float>::infinity();
  write_image(path("infinite.exr"), film, 0, {}, false);
  EXPECT_THROW(load_environment(path("infinite.exr")), Error);
  EXPECT_THROW(load_environment(path("missing.hdr")), Error);
  // A display image is decoded: what was written as linear 0.21 comes back as that.
  Film grey;
  grey.width = 2;
  grey.height = 1;
  grey.pixels.assign(2, Rgb(0.25F, 0.25F, 0.25F));
  write_image(path("grey.png"), grey, 0, {}, false);
  EXPECT_NEAR(load_environment(path("grey.png")).radiance[0].x, 0.21F, 2e-3F);  // half an 8-bit step
}

TEST(Film, ToneMapperIsContinuousAndBounded) {
  float last = 0;
  for (float x = 1e-4F; x < 1e5F; x *= 1.01F) {
    const float y = tone_map(Rgb(x, x, x)).x;
    EXPECT_GE(y, last);
    EXPECT_LT(y, 1.0F + 1e-6F);
    last = y;
  }
  EXPECT_NEAR(tone_map(Rgb(0.799F, 0.1F, 0.1F)).x, tone_map(Rgb(0.801F, 0.1F, 0.1F)).x, 3e-3F);
}

TEST(Film, AutoExposureBringsTheMeanToMiddleGrey) {
  Film film;
  film.width = 2;
  film.height = 2;
  film.pixels = {Rgb(0, 0, 0), Rgb(2, 2, 2), Rgb(8, 8, 8), Rgb(4, 4, 4)};
  EXPECT_NEAR(auto_exposure(film), std::log2(0.18F / 4), 1e-5F);
  film.pixels = {Rgb(1e-6F, 1e-6F, 1e-6F), Rgb(1e-6F, 1e-6F, 1e-6F), Rgb(1e-6F, 1e-6F, 1e-6F), Rgb(4, 4, 4)};
  EXPECT_NEAR(auto_exposure(film), -2, 1e-5F);  // the bright quarter to white
  film.pixels.assign(4, Rgb(0, 0, 0));
  EXPECT_EQ(auto_exposure(film), 0);
}

TEST(CompareImages, AgreesWithHandComputation) {
  Film reference;
  reference.width = 2;
  reference.height = 1;
  reference.pixels = {Rgb(0, 1, 2), Rgb(3, 4, 5)};
  Film image = reference;
  EXPECT_EQ(compare_images(image, reference).nrmse, 0);
  image.pixels[0] = Rgb(0, 1, 5);  // + 3
  image.pixels[1] = Rgb(3, 3, 5);  // - 1
  const ImageDifference d = compare_images(image, reference);
  EXPECT_DOUBLE_EQ(d.rmse, std::sqrt(10.0 / 6));
  EXPECT_DOUBLE_EQ(d.nrmse, std::sqrt(10.0 / 6) / 5);
  EXPECT_DOUBLE_EQ(d.max, 3);
  EXPECT_DOUBLE_EQ(d.bias, 2.0 / 6);
  EXPECT_DOUBLE_EQ(d.reference_mean, 2.5);
  const double floor = 0.025 * 0.025;
  EXPECT_DOUBLE_EQ(d.relative_rmse, std::sqrt((9 / (4 + floor) + 1 / (16 + floor)) / 6));
}

}  // namespace
}  // namespace ivory
