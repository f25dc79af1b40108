// Geometry as glTF defines it, on small documents whose triangles are known beforehand.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/gltf_check.h"
#include "tests/support/world_triangles.h"

namespace ivory {
namespace {

using nlohmann::json;

V3f front_normal(const Corners& c) {
  const V3f a(c[0][0], c[0][1], c[0][2]);
  const V3f b(c[1][0], c[1][1], c[1][2]);
  const V3f d(c[2][0], c[2][1], c[2][2]);
  return (b - a).cross(d - a).normalized();
}

// A zigzag and a regular pentagon in the xy plane, ordered so that strip and fan face +z.
const std::vector<V3f> zigzag{{0, 0, 0}, {0.5F, -1, 0}, {1, 0, 0}, {1.5F, -1, 0}, {2, 0, 0}};

TEST(GltfGeometry, StripsFaceOneWay) {
  GltfBuilder builder;
  builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", builder.add(zigzag)}}}, {"mode", 5}})}});
  const LoadedScene loaded = load(builder, "strip");
  const auto triangles = world_triangles(loaded.scene);
  ASSERT_EQ(triangles.size(), 3U);
  for (const Corners& t : triangles) EXPECT_EQ(front_normal(t), V3f(0, 0, 1));
}

TEST(GltfGeometry, IndexedStripEqualsListedTriangles) {
  GltfBuilder strip;
  const int indices = strip.add_indices({4, 3, 2, 1, 0});
  strip.add_node(
      {{"mesh",
        strip.add_mesh({{"attributes", {{"POSITION", strip.add(zigzag)}}}, {"indices", indices}, {"mode", 5}})}});
  GltfBuilder list;
  const int listed = list.add_indices({4, 3, 2, 3, 1, 2, 2, 1, 0});
  list.add_node({{"mesh", list.add_mesh({{"attributes", {{"POSITION", list.add(zigzag)}}}, {"indices", listed}})}});
  EXPECT_EQ(world_triangles(load(strip, "strip_indexed").scene), world_triangles(load(list, "strip_listed").scene));
}

TEST(GltfGeometry, FansFaceOneWayAndShareTheirFirstVertex) {
  std::vector<V3f> fan{{0, 0, 0}};
  for (int i = 0; i < 6; ++i) fan.emplace_back(std::cos(0.5F * float(i)), std::sin(0.5F * float(i)), 0.0F);
  GltfBuilder builder;
  builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", builder.add(fan)}}}, {"mode", 6}})}});
  const auto triangles = world_triangles(load(builder, "fan").scene);
  ASSERT_EQ(triangles.size(), 5U);
  const std::array<float, 3> hub{0, 0, 0};
  for (const Corners& t : triangles) {
    EXPECT_EQ(front_normal(t), V3f(0, 0, 1));
    EXPECT_EQ(std::count(t.begin(), t.end(), hub), 1);
  }
}

TEST(GltfGeometry, SampleOfAllPrimitiveModes) {
  const std::string folder = sample_data();
  if (folder.empty()) GTEST_SKIP() << no_sample_data;
  const LoadedScene loaded = load_gltf(folder + "/gltf/MeshPrimitiveModes/glTF/MeshPrimitiveModes.gltf");
  // Points and three kinds of lines are left out; strip, fan and list remain, each a flat patch.
  EXPECT_EQ(loaded.warnings.size(), 4U);
  EXPECT_EQ(loaded.scene.meshes.size(), 3U);
  const auto triangles = world_triangles(loaded.scene);
  for (const Corners& t : triangles) EXPECT_NEAR(front_normal(t).dot(front_normal(triangles.front())), 1, 1e-6);
}

TEST(GltfGeometry, SparseValuesReplaceTheirElements) {
  GltfBuilder builder;
  const int positions = builder.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  const std::uint16_t places[] = {1, 3};
  const float values[] = {2, 0, 0, 2, 2, 5};
  const int place_view = builder.add_view(places, sizeof places);
  const int value_view = builder.add_view(values, sizeof values);
  builder.root["accessors"][std::size_t(positions)]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", place_view}, {"componentType", 5123}}},
      {"values", {{"bufferView", value_view}}}};
  builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", positions}}}, {"mode", 5}})}});
  const LoadedScene loaded = load(builder, "sparse");
  EXPECT_EQ(loaded.scene.meshes[0].positions, (std::vector<V3f>{{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {2, 2, 5}}));
}

TEST(GltfGeometry, SparseAccessorWithoutViewStartsFromZeros) {
  GltfBuilder builder;
  const std::uint8_t places[] = {1, 2};
  const float values[] = {1, 0, 0, 0, 3, 0};
  const int place_view = builder.add_view(places, sizeof places);
  const int value_view = builder.add_view(values, sizeof values);
  const int positions = builder.add_accessor("VEC3", 5126, 3, -1);
  builder.root["accessors"][0]["sparse"] = {{"count", 2},
                                            {"indices", {{"bufferView", place_view}, {"componentType", 5121}}},
                                            {"values", {{"bufferView", value_view}}}};
  builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", positions}}}})}});
  EXPECT_EQ(load(builder, "sparse_zero").scene.meshes[0].positions,
            (std::vector<V3f>{{0, 0, 0}, {1, 0, 0}, {0, 3, 0}}));
}

TEST(GltfGeometry, SampleOfASparseAccessor) {
  const std::string folder = sample_data();
  if (folder.empty()) GTEST_SKIP() << no_sample_data;
  // Its note: three vertices of the upper row are moved up by sparse values, to y = 2, 3 and 4.
  const LoadedScene loaded = load_gltf(folder + "/gltf/SimpleSparseAccessor/glTF/SimpleSparseAccessor.gltf");
  const auto& p = loaded.scene.meshes[0].positions;
  ASSERT_EQ(p.size(), 14U);
  EXPECT_EQ(p[8].y, 2);
  EXPECT_EQ(p[10].y, 3);
  EXPECT_EQ(p[12].y, 4);
}

TEST(GltfGeometry, IntegersAreNormalisedAsTheSpecificationSays) {
  GltfBuilder builder;
  builder.use_extension("KHR_mesh_quantization");
  // Positions as plain shorts, padded to 8 bytes; normals, colours and uv normalised.
  const std::int16_t positions[] = {0, 0, 0, 9, 100, 0, 0, 9, 0, -100, 0, 9};
  const std::int8_t normals[] = {0, 0, 127, 0, 0, 0, -128, 0, 0, 127, 0, 0};
  const std::uint8_t colors[] = {255, 0, 51, 0, 0, 0, 0, 0, 255, 255, 255, 0};
  const std::uint16_t uvs[] = {65535, 0, 0, 65535, 13107, 0};
  builder.root["images"] = {
      {{"uri",
        "data:image/png;base64,"
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg=="}}};
  builder.root["textures"] = {{{"source", 0}}};
  builder.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  const int p = builder.add_accessor("VEC3", 5122, 3, builder.add_view(positions, sizeof positions, 8));
  const int n = builder.add_accessor("VEC3", 5120, 3, builder.add_view(normals, sizeof normals, 4), true);
  const int c = builder.add_accessor("VEC3", 5121, 3, builder.add_view(colors, sizeof colors, 4), true);
  const int t = builder.add_accessor("VEC2", 5123, 3, builder.add_view(uvs, sizeof uvs), true);
  builder.add_node(
      {{"mesh", builder.add_mesh({{"attributes", {{"POSITION", p}, {"NORMAL", n}, {"COLOR_0", c}, {"TEXCOORD_0", t}}},
                                  {"material", 0}})}});
  const Mesh mesh = load(builder, "quantized").scene.meshes.at(0);
  EXPECT_EQ(mesh.positions, (std::vector<V3f>{{0, 0, 0}, {100, 0, 0}, {0, -100, 0}}));
  // -128 is -1 as well.
  EXPECT_EQ(mesh.normals, (std::vector<V3f>{{0, 0, 1}, {0, 0, -1}, {0, 1, 0}}));
  ASSERT_EQ(mesh.colors.size(), 3U);
  EXPECT_EQ(mesh.colors[0], V4f(1, 0, 0.2F, 1));
  EXPECT_EQ(mesh.uvs.at(0), (std::vector<V2f>{{1, 0}, {0, 1}, {0.2F, 0}}));
}

TEST(GltfGeometry, QuantizedSampleMatchesThePlainOne) {
  const std::string folder = sample_data();
  if (folder.empty()) GTEST_SKIP() << no_sample_data;
  const Box3f plain = bounds(load_gltf(folder + "/gltf/AnimatedMorphCube/glTF/AnimatedMorphCube.gltf").scene);
  const Box3f quantized =
      bounds(load_gltf(folder + "/gltf/AnimatedMorphCube/glTF-Quantized/AnimatedMorphCube.gltf").scene);
  // Sixteen bits over two metres.
  EXPECT_LT((plain.min - quantized.min).length(), 1e-4F);
  EXPECT_LT((plain.max - quantized.max).length(), 1e-4F);
}

// The front side is where the winding is counter-clockwise in the mesh's own space, seen through
// the node's transform: a mirror turns the world winding over, which the determinant tells.
TEST(GltfGeometry, NegativeScaleKeepsTheWindingAndMirrorsTheTransform) {
  GltfBuilder builder;
  const int mesh = builder.add_triangle_mesh();
  builder.add_node({{"mesh", mesh}, {"scale", {-1, 2, 1}}, {"translation", {5, 0, 0}}});
  const LoadedScene loaded = load(builder, "mirrored");
  const Instance& instance = loaded.scene.instances.at(0);
  EXPECT_LT(instance.to_world.determinant(), 0);
  EXPECT_EQ(V3f(1, 1, 0) * instance.to_world, V3f(4, 2, 0));
  EXPECT_EQ(loaded.scene.meshes[0].triangles[0], Imath::Vec3<std::uint32_t>(0, 1, 2));
}

TEST(GltfGeometry, TransformsNest) {
  GltfBuilder builder;
  const int mesh = builder.add_triangle_mesh();
  // A quarter turn about +z: x goes to y.
  const float s = std::sqrt(0.5F);
  const int child = builder.add_node({{"mesh", mesh}, {"translation", {1, 0, 0}}, {"scale", {3, 1, 1}}}, false);
  builder.add_node({{"rotation", {0, 0, s, s}}, {"translation", {0, 0, 7}}, {"children", {child}}});
  const Instance instance = load(builder, "nested").scene.instances.at(0);
  const V3f p = V3f(1, 1, 0) * instance.to_world;  // (3,1,0), (4,1,0), (-1,4,0), (-1,4,7)
  EXPECT_LT((p - V3f(-1, 4, 7)).length(), 1e-5F);

  GltfBuilder by_matrix;
  const int same = by_matrix.add_triangle_mesh();
  by_matrix.add_node({{"mesh", same}, {"matrix", {0, 3, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 7, 1}}});
  const Instance other = load(by_matrix, "nested_matrix").scene.instances.at(0);
  for (int i = 0; i < 16; ++i) EXPECT_NEAR(instance.to_world[i / 4][i % 4], other.to_world[i / 4][i % 4], 1e-6);
}

TEST(GltfGeometry, SharedMeshesAreNotCopied) {
  GltfBuilder builder;
  const int mesh = builder.add_triangle_mesh();
  for (int i = 0; i < 5; ++i) builder.add_node({{"mesh", mesh}, {"translation", {i, 0, 0}}});
  const LoadedScene loaded = load(builder, "shared");
  EXPECT_EQ(loaded.scene.meshes.size(), 1U);
  ASSERT_EQ(loaded.scene.instances.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(loaded.scene.instances[i].to_world[3][0], float(i));
}

TEST(GltfGeometry, GpuInstancingPlacesEachElementWithinItsNode) {
  GltfBuilder builder;
  builder.use_extension("EXT_mesh_gpu_instancing");
  const int mesh = builder.add_triangle_mesh();
  const int translation = builder.add({{1, 0, 0}, {0, 2, 0}});
  // The second element turns a quarter about +z, as normalised shorts.
  const std::int16_t quaternions[] = {0, 0, 0, 32767, 0, 0, 23170, 23170};
  const int rotation = builder.add_accessor("VEC4", 5122, 2, builder.add_view(quaternions, sizeof quaternions), true);
  const int scale = builder.add({{1, 1, 1}, {2, 2, 2}});
  builder.add_node({{"mesh", mesh},
                    {"translation", {0, 0, 10}},
                    {"extensions",
                     {{"EXT_mesh_gpu_instancing",
                       {{"attributes", {{"TRANSLATION", translation}, {"ROTATION", rotation}, {"SCALE", scale}}}}}}}});
  const Scene scene = load(builder, "gpu_instancing").scene;
  EXPECT_EQ(scene.meshes.size(), 1U);
  ASSERT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(V3f(1, 0, 0) * scene.instances[0].to_world, V3f(2, 0, 10));
  // (1,0,0) doubled, turned to (0,2,0), moved to (0,4,0); 16 bits make an angle of 1e-5.
  EXPECT_LT((V3f(1, 0, 0) * scene.instances[1].to_world - V3f(0, 4, 10)).length(), 1e-4F);
}

TEST(GltfGeometry, DegenerateTrianglesAndStrayVerticesGo) {
  GltfBuilder builder;
  const int positions = builder.add({{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}});
  // A repeated index, three points on a line, a good triangle.
  const int indices = builder.add_indices({1, 1, 2, 1, 2, 4, 1, 2, 3});
  builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}})}});
  const LoadedScene loaded = load(builder, "degenerate");
  ASSERT_EQ(loaded.scene.meshes.at(0).triangles.size(), 1U);
  EXPECT_EQ(loaded.scene.meshes[0].positions.size(), 3U);
  EXPECT_TRUE(has_warning(loaded, "2 triangles without area"));
  EXPECT_EQ(bounds(loaded.scene).max, V3f(1, 1, 0));
}

// Primitives that share one long vertex array each keep their own part of it.
TEST(GltfGeometry, PartsOfASharedVertexArray) {
  GltfBuilder builder;
  const int positions = builder.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {9, 9, 9}});
  const int normals = builder.add({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  const json attributes = {{"POSITION", positions}, {"NORMAL", normals}};
  const int mesh = builder.add_mesh({{"attributes", attributes}, {"indices", builder.add_indices({0, 1, 2})}});
  builder.root["meshes"][0]["primitives"].push_back(
      {{"attributes", attributes}, {"indices", builder.add_indices({4, 5, 3})}});
  builder.add_node({{"mesh", mesh}});
  const Scene scene = load(builder, "shared_array").scene;
  ASSERT_EQ(scene.meshes.size(), 2U);
  EXPECT_EQ(scene.meshes[1].positions, (std::vector<V3f>{{5, 0, 0}, {6, 0, 0}, {5, 1, 0}}));
  EXPECT_EQ(scene.meshes[1].normals, (std::vector<V3f>{{0, 1, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(world_triangles(scene)[1], (Corners{{{5, 0, 0}, {6, 0, 0}, {5, 1, 0}}}));
}

TEST(GltfGeometry, ASceneWithoutTrianglesLoads) {
  GltfBuilder builder;
  const LoadedScene loaded = load(builder, "empty");
  EXPECT_TRUE(loaded.scene.instances.empty());
  EXPECT_TRUE(bounds(loaded.scene).isEmpty());
  EXPECT_TRUE(has_warning(loaded, "no triangles"));
}

TEST(GltfGeometry, AFlattenedMeshKeepsItsAreaInWorldSpace) {
  GltfBuilder builder;
  const int mesh = builder.add_triangle_mesh();
  builder.add_node({{"mesh", mesh}, {"scale", {2, 3, 0}}, {"translation", {0, 0, 4}}});
  builder.add_node({{"mesh", mesh}, {"scale", {0, 3, 1}}});
  const LoadedScene loaded = load(builder, "flattened");
  ASSERT_EQ(loaded.scene.instances.size(), 1U);
  const auto triangles = world_triangles(loaded.scene);
  EXPECT_EQ(triangles[0], (Corners{{{0, 0, 4}, {2, 0, 4}, {0, 3, 4}}}));
  EXPECT_TRUE(has_warning(loaded, "scales its mesh to nothing"));
}

TEST(GltfGeometry, BadGeometryIsRefused) {
  const float nan = std::nanf("");
  GltfBuilder not_finite;
  not_finite.add_node(
      {{"mesh",
        not_finite.add_mesh({{"attributes", {{"POSITION", not_finite.add({{0, 0, 0}, {1, nan, 0}, {0, 1, 0}})}}}})}});
  EXPECT_NE(error_of(not_finite, "nan").find("not finite at element 1"), std::string::npos);

  GltfBuilder beyond;
  const int positions = beyond.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  beyond.add_node({{"mesh", beyond.add_mesh({{"attributes", {{"POSITION", positions}}},
                                             {"indices", beyond.add_indices({0, 1, 3})}})}});
  EXPECT_NE(error_of(beyond, "index").find("index 3 but 3 vertices"), std::string::npos);

  GltfBuilder far;
  const int far_mesh = far.add_triangle_mesh();
  far.add_node({{"mesh", far_mesh}, {"scale", {1e20, 1e20, 1e20}}});
  EXPECT_NE(error_of(far, "far").find("farther out"), std::string::npos);

  GltfBuilder unequal;
  const int p = unequal.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const int n = unequal.add({{0, 0, 1}, {0, 0, 1}});
  unequal.add_node({{"mesh", unequal.add_mesh({{"attributes", {{"POSITION", p}, {"NORMAL", n}}}})}});
  EXPECT_NE(error_of(unequal, "unequal").find("NORMAL of 2 vertices but POSITION of 3"), std::string::npos);
}

}  // namespace
}  // namespace ivory
