// Images of glTF files, as OpenImageIO writes them.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <webp/encode.h>

#include "tests/support/gltf_check.h"
#include "tests/tracer/gltf/textured.h"

namespace ivory {
namespace {

using nlohmann::json;

std::string write_png(const std::string& name, int width, int height, int channels,
                      const std::vector<std::uint8_t>& pixels) {
  const std::string path = GltfBuilder::folder() + "/" + name;
  auto out = OIIO::ImageOutput::create(path);
  OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  EXPECT_TRUE(out->open(path, spec));
  EXPECT_TRUE(out->write_image(OIIO::TypeDesc::UINT8, pixels.data()));
  out->close();
  return path;
}

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(GltfImages, KeepTheirColourBehindAlpha) {
  write_png("alpha.png", 2, 1, 4, {200, 100, 50, 0, 10, 20, 30, 128});
  Scene scene = load(textured({{"uri", "alpha.png"}}).write("image_alpha")).scene;
  EXPECT_EQ(scene.images.at(0).rgba, (std::vector<std::uint8_t>{200, 100, 50, 0, 10, 20, 30, 128}));

  write_png("grey.png", 2, 1, 1, {7, 255});
  scene = load(textured({{"uri", "grey.png"}}).write("image_grey")).scene;
  EXPECT_EQ(scene.images.at(0).rgba, (std::vector<std::uint8_t>{7, 7, 7, 255, 255, 255, 255, 255}));

  write_png("rgb%20space.png", 1, 1, 3, {1, 2, 3});
  std::filesystem::rename(GltfBuilder::folder() + "/rgb%20space.png", GltfBuilder::folder() + "/rgb space.png");
  scene = load(textured({{"uri", "rgb%20space.png"}}).write("image_rgb")).scene;
  EXPECT_EQ(scene.images.at(0).rgba, (std::vector<std::uint8_t>{1, 2, 3, 255}));

  // As WebP, which image libraries like to multiply by alpha.
  const std::vector<std::uint8_t> rgba{200, 100, 50, 16, 10, 20, 30, 128};
  std::uint8_t* webp = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(rgba.data(), 2, 1, 8, &webp);
  GltfBuilder::write_file(GltfBuilder::folder() + "/alpha.webp", {reinterpret_cast<const char*>(webp), size});
  WebPFree(webp);
  GltfBuilder as_webp = textured({{"uri", "alpha.webp"}, {"mimeType", "image/webp"}});
  as_webp.use_extension("EXT_texture_webp");
  as_webp.root["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
  scene = load(as_webp.write("image_webp")).scene;
  EXPECT_EQ(scene.images.at(0).rgba, rgba);

  // From a buffer view.
  const std::string png = read_file(GltfBuilder::folder() + "/alpha.png");
  GltfBuilder embedded = textured(json::object());
  embedded.root["images"][0] = {{"bufferView", embedded.add_view(png.data(), png.size())}, {"mimeType", "image/png"}};
  scene = load(embedded.write("image_embedded")).scene;
  EXPECT_EQ(scene.images.at(0).rgba[0], 200);
}

TEST(GltfImages, BrokenOnesAreRefusedWhereTheyAreShown) {
  std::vector<std::uint8_t> noise;
  for (int i = 0; i < 64 * 64 * 3; ++i) noise.push_back(static_cast<std::uint8_t>(i * 7919 >> 3));
  for (const char* extension : {"png", "jpg", "webp"}) {
    const std::string name = std::string("noise.") + extension;
    const std::string whole = read_file(write_png(name, 64, 64, 3, noise));
    GltfBuilder builder = textured({{"uri", "cut_" + name}});
    GltfBuilder::write_file(GltfBuilder::folder() + "/cut_" + name, whole);
    EXPECT_EQ(error_of(builder, "image_whole"), "") << extension;
    for (const std::size_t keep :
         {std::size_t(2), whole.size() / 4, whole.size() / 2, whole.size() * 9 / 10, whole.size() - 20}) {
      GltfBuilder::write_file(GltfBuilder::folder() + "/cut_" + name, whole.substr(0, keep));
      EXPECT_NE(error_of(builder, "image_cut").find("images[0]"), std::string::npos) << extension << " " << keep;
    }
  }
  // The header of a WebP of 2 x 2 pixels that moves.
  GltfBuilder::write_file(GltfBuilder::folder() + "/moving.webp",
                          std::string("RIFF\x16\0\0\0WEBPVP8X\x0A\0\0\0\x02\0\0\0\1\0\0\1\0\0", 30));
  EXPECT_NE(error_of(textured({{"uri", "moving.webp"}}), "image_moving").find("animation"), std::string::npos);
  EXPECT_NE(error_of(textured({{"uri", "nowhere.png"}}), "image_missing").find("no such file"), std::string::npos);
  EXPECT_NE(error_of(textured({{"uri", "."}}), "image_folder").find("not a regular file"), std::string::npos);

  // A sound PNG that says 30000 x 30000 pixels in 69 bytes.
  const std::string bomb =
      "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAdTAAAHUwCAYAAABmJ/"
      "i6AAAADElEQVR4nGNgoD0AAABkAAGGZDw1AAAAAElFTkSuQmCC";
  EXPECT_NE(error_of(textured({{"uri", bomb}}), "image_bomb").find("claims 30000 x 30000"), std::string::npos);
}

TEST(GltfImages, TheHashCoversThem) {
  write_png("hashed.png", 1, 1, 3, {1, 2, 3});
  const std::string path = textured({{"uri", "hashed.png"}}).write("hash");
  const std::string first = load_gltf(path).scene.content_hash;
  EXPECT_EQ(load_gltf(path).scene.content_hash, first);
  write_png("hashed.png", 1, 1, 3, {1, 2, 4});
  EXPECT_NE(load_gltf(path).scene.content_hash, first);
}

}  // namespace
}  // namespace ivory
