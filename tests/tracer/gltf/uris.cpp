// Where the bytes of a file lie, as exporters write it beside what the specification allows.
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/gltf_check.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A triangle whose one buffer has that uri.
std::string write_gltf(const std::string& name, const std::string& uri, const GltfBuilder& builder) {
  json root = builder.root;
  root["buffers"] = {{{"byteLength", builder.bytes.size()}, {"uri", uri}}};
  const std::string path = GltfBuilder::folder() + "/" + name;
  fs::create_directories(fs::path(path).parent_path());
  GltfBuilder::write_file(path, root.dump());
  return path;
}

GltfBuilder triangle() {
  GltfBuilder builder;
  builder.add_node({{"mesh", builder.add_triangle_mesh()}});
  return builder;
}

std::string bytes_of(const GltfBuilder& builder) { return {builder.bytes.begin(), builder.bytes.end()}; }

// Base64 of the triangle's 36 bytes: (0, 0, 0), (1, 0, 0), (0, 1, 0).
const std::string text = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";

TEST(GltfUris, DataInAnyCaseAndInLines) {
  const GltfBuilder builder = triangle();
  std::string lines = text;
  for (std::size_t i = 40; i > 0; i -= 10) lines.insert(i, "\r\n ");
  for (const std::string& uri :
       {"data:application/octet-stream;base64," + text, "data:application/octet-stream;BASE64," + text,
        "DATA:application/gltf-buffer;Base64," + text, "data:;base64," + lines, "data:;base64,%0A" + text + "%0a"}) {
    const LoadedScene loaded = load(write_gltf("data.gltf", uri, builder));
    EXPECT_EQ(bounds(loaded.scene).max, V3f(1, 1, 0)) << uri;
    EXPECT_TRUE(loaded.warnings.empty()) << uri;
  }
  for (const std::string& uri :
       {"data:;base64,!" + text, "data:;base64," + text.substr(4), std::string("data:;base64")})
    EXPECT_THROW(load_gltf(write_gltf("data.gltf", uri, builder)), Error) << uri;
}

TEST(GltfUris, PathsThatAreNoUris) {
  const GltfBuilder builder = triangle();
  const std::string folder = GltfBuilder::folder();
  fs::remove_all(folder);  // of an earlier run
  fs::create_directories(folder + "/sub");
  GltfBuilder::write_file(folder + "/sub/x.bin", bytes_of(builder));
  GltfBuilder::write_file(folder + "/100%25.bin", bytes_of(builder));
  const auto taken = [&](const std::string& uri, const char* word) {
    const LoadedScene loaded = load(write_gltf("named.gltf", uri, builder));
    EXPECT_EQ(loaded.scene.instances.size(), 1U) << uri;
    EXPECT_EQ(loaded.warnings.empty(), *word == 0) << uri;
    EXPECT_TRUE(*word == 0 || has_warning(loaded, word)) << uri;
  };
  taken("sub/x.bin", "");
  taken("./sub/%78.bin", "");
  taken("100%25.bin", "");  // the name itself, where 100%.bin is not there
  taken("sub\\x.bin", "backslashes");
  taken("sub/x.bin?v=1", "without its query");
  taken("sub/x.bin?t=1:2#part", "without its query");
  taken("sub\\x.bin?v=1", "without its query, with slashes");
  // What is there by its very name comes first.
  GltfBuilder::write_file(folder + "/sub/x.bin?v=1", bytes_of(builder));
  taken("sub/x.bin?v=1", "");
  EXPECT_THROW(load_gltf(write_gltf("named.gltf", "C:\\models\\x.bin", builder)), Error);
  EXPECT_THROW(load_gltf(write_gltf("named.gltf", "sub\\y.bin", builder)), Error);
  EXPECT_THROW(load_gltf(write_gltf("named.gltf", "", builder)), Error);
}

TEST(GltfUris, LinkedFilesFindWhatLiesBesideTheirTarget) {
  const GltfBuilder builder = triangle();
  const std::string folder = GltfBuilder::folder();
  fs::remove_all(folder);
  const std::string target = write_gltf("store/model.gltf", "model.bin", builder);
  GltfBuilder::write_file(folder + "/store/model.bin", bytes_of(builder));
  fs::create_directories(folder + "/links");
  fs::create_symlink("../store/model.gltf", folder + "/links/first.gltf");
  fs::create_symlink("first.gltf", folder + "/links/second.gltf");
  for (const char* link : {"/links/first.gltf", "/links/second.gltf"}) {
    const LoadedScene loaded = load(folder + link);
    EXPECT_EQ(bounds(loaded.scene).max, V3f(1, 1, 0));
    EXPECT_EQ(loaded.scene.content_hash, load(target).scene.content_hash);
  }
  // Beside the link comes first.
  GltfBuilder other = triangle();
  other.bytes[14] = 0;
  other.bytes[15] = 0x40;  // 2 instead of 1
  GltfBuilder::write_file(folder + "/links/model.bin", bytes_of(other));
  EXPECT_EQ(bounds(load(folder + "/links/first.gltf").scene).max.x, 2);
}

}  // namespace
}  // namespace ivory
