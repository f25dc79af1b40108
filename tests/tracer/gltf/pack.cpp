// A scene packed into one .glb is the same scene.
#include "tracer/gltf/pack.h"

#include <filesystem>

#include "grid/base/error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/scene_check.h"
#include "tracer/gltf/loader.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

void expect_same_scene(const std::string& file) {
  SCOPED_TRACE(file);
  const PackedScene packed = pack_glb(file);
  const std::string alone = GltfBuilder::folder() + "/alone/packed.glb";
  fs::create_directories(fs::path(alone).parent_path());  // nothing that the file refers to lies there
  GltfBuilder::write_file(alone, packed.bytes);
  EXPECT_EQ(packed.bytes.size() % 4, 0U);
  const Scene a = load_gltf(file, {.uv_sets = {0, 1}}).scene;
  const Scene b = load_gltf(alone, {.uv_sets = {0, 1}}).scene;
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t i = 0; i < a.meshes.size(); ++i) {
    EXPECT_EQ(a.meshes[i].positions, b.meshes[i].positions);
    EXPECT_EQ(a.meshes[i].normals, b.meshes[i].normals);
    EXPECT_EQ(a.meshes[i].uvs, b.meshes[i].uvs);
    EXPECT_EQ(a.meshes[i].triangles, b.meshes[i].triangles);
  }
  ASSERT_EQ(a.images.size(), b.images.size());
  for (std::size_t i = 0; i < a.images.size(); ++i) EXPECT_EQ(a.images[i].rgba, b.images[i].rgba);
  ASSERT_EQ(a.instances.size(), b.instances.size());
  for (std::size_t i = 0; i < a.instances.size(); ++i) {
    EXPECT_EQ(a.instances[i].node, b.instances[i].node);
    EXPECT_EQ(a.instances[i].to_world, b.instances[i].to_world);
  }
  EXPECT_EQ(a.lights.size(), b.lights.size());
  EXPECT_EQ(a.light_nodes, b.light_nodes);
  EXPECT_EQ(a.cameras.size(), b.cameras.size());
}

TEST(GltfPack, BundledScenesStayAsTheyAre) {
  for (const char* name : {"room_boxes.gltf", "two_rooms.gltf", "crowd.glb", "plaza.gltf"})
    expect_same_scene(std::string(source_folder) + "/scenes/" + name);
}

// Buffers and images beside the file, several buffers, sparse accessors, a .glb with images, Draco.
TEST(GltfPack, SampleAssetsStayAsTheyAre) {
  const std::string data = sample_data();
  if (data.empty()) GTEST_SKIP() << no_sample_data;
  int scenes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(data + "/gltf")) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".gltf" && extension != ".glb") continue;
    if (entry.file_size() > 1'000'000) continue;
    expect_same_scene(entry.path().string());
    ++scenes;
  }
  EXPECT_GT(scenes, 15);
}

TEST(GltfPack, SaysWhatIsMissing) {
  GltfBuilder builder;
  builder.add_node({{"mesh", builder.add_triangle_mesh()}});
  builder.root["images"] = {{{"uri", "not_there.png"}}};
  const std::string path = builder.write("missing");
  try {
    pack_glb(path);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("not_there.png"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace ivory
