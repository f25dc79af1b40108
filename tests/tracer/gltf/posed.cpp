// Files that are posed again and again, against loading them at each time.
#include "tracer/gltf/posed.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/paths.h"

namespace ivory {
namespace {

void expect_same(const Scene& posed, const Scene& loaded, const std::string& what) {
  ASSERT_EQ(posed.instances.size(), loaded.instances.size()) << what;
  for (std::size_t i = 0; i < loaded.instances.size(); ++i) {
    EXPECT_TRUE(posed.instances[i].to_world == loaded.instances[i].to_world) << what;
    EXPECT_EQ(posed.instances[i].mesh, loaded.instances[i].mesh) << what;
    EXPECT_EQ(posed.instances[i].node, loaded.instances[i].node) << what;
  }
  ASSERT_EQ(posed.meshes.size(), loaded.meshes.size()) << what;
  for (std::size_t i = 0; i < loaded.meshes.size(); ++i) {
    EXPECT_TRUE(posed.meshes[i].positions == loaded.meshes[i].positions) << what;
    EXPECT_TRUE(posed.meshes[i].normals == loaded.meshes[i].normals) << what;
    EXPECT_TRUE(posed.meshes[i].tangents == loaded.meshes[i].tangents) << what;
    EXPECT_TRUE(posed.meshes[i].triangles == loaded.meshes[i].triangles) << what;
    EXPECT_EQ(posed.meshes[i].material, loaded.meshes[i].material) << what;
  }
  EXPECT_EQ(posed.materials.size(), loaded.materials.size()) << what;
  EXPECT_EQ(posed.lights.size(), loaded.lights.size()) << what;
  EXPECT_EQ(posed.cameras.size(), loaded.cameras.size()) << what;
  EXPECT_EQ(posed.content_hash, loaded.content_hash) << what;
  EXPECT_EQ(posed.anchor_m, loaded.anchor_m) << what;
}

// Skins, morphs, node animations and all interpolations; forth and back, so that no pose is left of the one before.
TEST(PosedGltf, IsTheFileLoadedAtThatTime) {
  const char* data = std::getenv("IVORY_DATA");
  if (data == nullptr) GTEST_SKIP() << "IVORY_DATA names no folder of sample data (CONTRIBUTING.md)";
  const std::filesystem::path folder = std::filesystem::path(data) / "animated";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string path = entry.path().string();
    if (!path.ends_with(".gltf") && !path.ends_with(".glb")) continue;
    ++files;
    PosedGltf posed(path, {});
    ASSERT_FALSE(posed.animations().empty()) << path;
    for (std::size_t animation = 0; animation < posed.animations().size(); ++animation) {
      const AnimationSpan& span = posed.animations()[animation];
      EXPECT_LT(span.begin_s, span.end_s) << path;
      for (const double share : {0.3, 1.0, 0.0, 0.7, 1.5}) {
        LoadParams params;
        params.time_s = span.begin_s + share * (span.end_s - span.begin_s);
        params.animation = std::to_string(animation);
        const Scene loaded = load_gltf(path, params).scene;
        expect_same(posed.pose(animation, *params.time_s, loaded.anchor_m), loaded,
                    path + " at " + std::to_string(*params.time_s));
      }
    }
  }
  EXPECT_GE(files, 6);
}

TEST(PosedGltf, KeepsTheAnchorItIsGiven) {
  GltfBuilder gltf;
  const int times = gltf.add_accessor("SCALAR", 5126, 2, gltf.add_view(std::vector<float>{0, 2}.data(), 8));
  gltf.root["accessors"][times]["min"] = {0};
  gltf.root["accessors"][times]["max"] = {2};
  const int places = gltf.add(std::vector<V3f>{{5000, 0, 0}, {9000, 0, 0}});
  const int node = gltf.add_node({{"mesh", gltf.add_triangle_mesh()}});
  gltf.root["animations"] = {{{"name", "go"},
                              {"samplers", {{{"input", times}, {"output", places}}}},
                              {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", "translation"}}}}}}}};
  const std::string path = gltf.write("moves_far");
  PosedGltf posed(path, {});
  ASSERT_EQ(posed.animations().size(), 1U);
  EXPECT_EQ(posed.animations()[0].name, "go");
  EXPECT_EQ(posed.animations()[0].end_s, 2);
  const V3d anchor_m(4000, 0, 0);
  for (const double time_s : {0.0, 1.0, 2.0}) {
    const Scene scene = posed.pose(0, time_s, anchor_m);
    EXPECT_EQ(scene.anchor_m, anchor_m);
    ASSERT_EQ(scene.instances.size(), 1U);
    EXPECT_NEAR(scene.instances[0].to_world[3][0], 1000 + 2000 * time_s, 1e-2);
  }
  EXPECT_THROW(posed.pose(1, 0, anchor_m), ParameterError);
  EXPECT_TRUE(PosedGltf(GltfBuilder().write("empty_of_animations"), {}).animations().empty());
}

}  // namespace
}  // namespace ivory
