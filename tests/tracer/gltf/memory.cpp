// Small files that ask for more memory than there is: refused before it is taken. The limit is lowered for the while
// by the soft limit on address space (ulimit -v), so that the tests do the same on any machine.
#include "grid/base/memory.h"

#include <array>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <zlib.h>

#include "tests/support/gltf_check.h"
#include "tracer/gltf/images.h"

namespace ivory {
namespace {

using nlohmann::json;

class LoweredLimit {
 public:
  explicit LoweredLimit(double bytes) {
    EXPECT_EQ(getrlimit(RLIMIT_AS, &before_), 0);
    rlimit lowered = before_;
    lowered.rlim_cur = rlim_t(bytes);
    EXPECT_EQ(setrlimit(RLIMIT_AS, &lowered), 0);
  }
  ~LoweredLimit() { setrlimit(RLIMIT_AS, &before_); }
  LoweredLimit(const LoweredLimit&) = delete;
  LoweredLimit& operator=(const LoweredLimit&) = delete;

 private:
  rlimit before_{};
};

std::string word(std::size_t value) {
  std::string text(4, '\0');
  for (std::size_t i = 0; i < 4; ++i) text[i] = char(value >> (24 - 8 * i) & 0xFFU);
  return text;
}

std::string chunk(const std::string& kind, const std::string& data) {
  const std::string body = kind + data;
  const uLong sum = crc32(0, reinterpret_cast<const Bytef*>(body.data()), uInt(body.size()));
  return word(data.size()) + body + word(sum);
}

// One bit a pixel, right checksums, and as many bytes as such an image can be packed into.
std::string huge_png(std::size_t side) {
  const std::string header = word(side) + word(side) + std::string("\1\0\0\0\0", 5);
  return "\x89PNG\r\n\x1A\n" + chunk("IHDR", header) + chunk("IDAT", std::string(side * side / 8200, '\0')) +
         chunk("IEND", "");
}

// A triangle with as many materials' worth of images as `names`.
GltfBuilder textured(const std::vector<std::string>& names) {
  GltfBuilder builder;
  json primitives = json::array();
  const int p = builder.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const int t = builder.add(std::vector<V2f>{{0, 0}, {1, 0}, {0, 1}});
  for (std::size_t i = 0; i < names.size(); ++i) {
    builder.root["images"].push_back({{"uri", names[i]}});
    builder.root["textures"].push_back({{"source", i}});
    builder.root["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
    primitives.push_back({{"attributes", {{"POSITION", p}, {"TEXCOORD_0", t}}}, {"material", i}});
  }
  builder.root["meshes"] = {{{"primitives", primitives}}};
  builder.add_node({{"mesh", 0}});
  return builder;
}

TEST(GltfMemory, ImagesAreWeighedBeforeTheyAreDecoded) {
  const std::string png = huge_png(32768);
  EXPECT_LT(png.size(), 140000U);
  GltfBuilder::write_file(GltfBuilder::folder() + "/huge.png", png);
  // 4 GiB to keep, 12 a thread to decode.
  const LoweredLimit limit(8e9);
  const std::string error = error_of(textured({"huge.png"}), "huge");
  EXPECT_NE(error.find("GiB of memory"), std::string::npos) << error;
  EXPECT_NE(error.find("use smaller images"), std::string::npos) << error;
}

TEST(GltfMemory, ImagesAddUp) {
  GltfBuilder::write_file(GltfBuilder::folder() + "/large.png", huge_png(8192));
  // 0.25 GiB to keep and at most 1.5 GiB to decode by two threads, of 6 GiB that may be used. The image is not sound:
  // it comes as far as its decoder.
  const LoweredLimit limit(8 * 0x1p30);
  EXPECT_NE(error_of(textured({"large.png"}), "one").find("cannot be decoded"), std::string::npos);
  const std::vector<std::string> many(24, "large.png");
  EXPECT_NE(error_of(textured(many), "many").find("GiB of memory"), std::string::npos);
}

// Decoders may take memory for the whole image as they open the file: the claim is found before.
TEST(GltfMemory, ClaimsAreReadFromEveryFormat) {
  Image image;
  const auto cause = [&](const std::string& file) {
    return gltf::decode_image({reinterpret_cast<const std::uint8_t*>(file.data()), file.size()}, image);
  };
  // A progressive JPEG behind an application segment, 200 bytes in all.
  const std::string jpeg =
      std::string("\xFF\xD8\xFF\xE0\0\4ab\xFF\xC2\0\x11\x08\x7D\0\x7D\0\3", 19) + std::string(179, '\1') + "\xFF\xD9";
  EXPECT_EQ(cause(jpeg), "claims 32000 x 32000 pixels in 200 bytes");
  const std::string riff("RIFF\0\1\0\0WEBP", 12);
  EXPECT_EQ(cause(riff + std::string("VP8X\n\0\0\0\0\0\0\0\xFF\x3F\0\xFE\x3F\0", 18)),
            "claims 16384 x 16383 pixels in 30 bytes");
  EXPECT_EQ(cause(riff + std::string("VP8L\n\0\0\0\x2F\xFF\xFF\xFF\x0F\0\0\0\0\0", 18)),
            "claims 16384 x 16384 pixels in 30 bytes");
  EXPECT_EQ(cause(riff + std::string("VP8 \n\0\0\0\0\0\0\x9D\x01\x2A\xFF\x3F\xFE\x3F", 18)),
            "claims 16383 x 16382 pixels in 30 bytes");
}

// An accessor without a view is zeros: a million instances from a few hundred bytes.
TEST(GltfMemory, InstancesAreWeighedBeforeTheyArePlaced) {
  const auto file = [](std::size_t count, std::size_t primitives, float scale) {
    GltfBuilder builder;
    builder.use_extension("EXT_mesh_gpu_instancing");
    const int p = builder.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    builder.root["meshes"] = {{{"primitives", std::vector<json>(primitives, {{"attributes", {{"POSITION", p}}}})}}};
    const int moves = builder.add_accessor("VEC3", 5126, count, -1);
    builder.add_node({{"mesh", 0},
                      {"scale", {1, scale, 1}},
                      {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", moves}}}}}}}});
    return builder;
  };
  const LoweredLimit limit(4 * 0x1p30);
  EXPECT_EQ(error_of(file(1000, 2, 1), "some"), "");
  const std::string error = error_of(file(1000000, 20, 1), "million");
  EXPECT_NE(error.find("GiB of memory"), std::string::npos) << error;
  EXPECT_NE(error.find("place fewer instances"), std::string::npos) << error;

  // The same by nodes: every one places all of the mesh.
  GltfBuilder nodes = file(1, 3000, 1);
  for (int i = 0; i < 3000; ++i) nodes.add_node({{"mesh", 0}});
  EXPECT_NE(error_of(nodes, "nodes").find("place fewer instances"), std::string::npos);
}

// A hundred bytes of file become a mesh of 5120 triangles.
TEST(GltfMemory, SphericalLightsAreWeighedBeforeTheyArePlaced) {
  GltfBuilder builder;
  const int p = builder.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  builder.root["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", p}}}}}}}};
  builder.add_node({{"mesh", 0}});
  for (int i = 0; i < 2000; ++i)
    builder.add_node({{"extras", {{"ivory_sphere_light", {{"radius", 1}, {"radiance", {1, 1, 1}}}}}}});
  const LoweredLimit limit(4 * 0x1p30);
  const std::string error = error_of(builder, "spheres");
  EXPECT_NE(error.find("place fewer spherical lights"), std::string::npos) << error;
}

// A mesh of zeros, which take no bytes in the file, by a thousand nodes that each pose it in their own way.
TEST(GltfMemory, PosesAreWeighedBeforeTheyAreMade) {
  GltfBuilder builder;
  const int zeros = builder.add_accessor("VEC3", 5126, 300'000, -1);
  builder.add_mesh({{"attributes", {{"POSITION", zeros}}}, {"targets", {{{"POSITION", zeros}}}}});
  for (int i = 0; i < 1000; ++i) builder.add_node({{"mesh", 0}, {"weights", {0.001 * i + 0.1}}});
  const LoweredLimit limit(8e9);
  const std::string error = error_of(builder, "poses");
  EXPECT_NE(error.find("GiB of memory"), std::string::npos) << error;
  EXPECT_NE(error.find("pose fewer meshes"), std::string::npos) << error;
}

}  // namespace
}  // namespace ivory
