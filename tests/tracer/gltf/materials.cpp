// Materials and textures of glTF files.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/gltf_check.h"
#include "tests/tracer/gltf/textured.h"
#include "tracer/core/intersector.h"
#include "tracer/core/lit_scene.h"
#include "tracer/core/texture.h"

namespace ivory {
namespace {

using nlohmann::json;

const Material& material_named(const Scene& scene, const std::string& name) {
  return *std::find_if(scene.materials.begin(), scene.materials.end(),
                       [&](const Material& m) { return m.name == name; });
}

// Khronos' sample marks, on quads that show u right and v down, where its arrow must point; the
// arrow lies on the texture's diagonal and its tip's extension meets (0.778, 0.778).
TEST(GltfMaterials, TextureTransformsPointTheArrowAtTheSamplesMarks) {
  const std::string folder = sample_data();
  if (folder.empty()) GTEST_SKIP() << no_sample_data;
  const Scene scene = load(folder + "/gltf/TextureTransformTest/glTF/TextureTransformTest.gltf").scene;
  const auto transformed = [&](const char* material, float x, float y) {
    const auto& m = material_named(scene, material).base_color_texture.uv_transform;
    const float u = x + 0.5F;
    const float v = 0.5F - y;
    return V2f(m[0] * u + m[1] * v + m[2], m[3] * u + m[4] * v + m[5]);
  };
  const V2f tip(0.7778175F, 0.7778175F);
  EXPECT_LT((transformed("Rotation", -0.0790482F, -0.5162675F) - tip).length(), 1e-5F);
  EXPECT_LT((transformed("Scale", 0.0185450F, -0.0185450F) - tip).length(), 1e-5F);
  // This mark was set by eye, to two digits, somewhere along the diagonal.
  const V2f all = transformed("All", -0.07F, -0.25F);
  EXPECT_NEAR(all.x, all.y, 0.05F);
  EXPECT_EQ(transformed("Offset U", -0.5F, 0.5F), V2f(0.5F, 0));
  EXPECT_EQ(transformed("Offset V", -0.5F, 0.5F), V2f(0, 0.5F));
  // Clamped, unlike glTF's default.
  EXPECT_EQ(scene.textures[0].wrap_s, Wrap::clamp_to_edge);
}

// A quarter turn counter-clockwise takes "right" (1, 0) to "up", which is (0, -1) where v points down.
TEST(GltfMaterials, TextureRotationIsCounterClockwiseAndComesAfterScale) {
  GltfBuilder builder = textured({{"uri", white_pixel}});
  builder.use_extension("KHR_texture_transform");
  builder.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"rotation", 1.5707963267948966}, {"scale", {2, 3}}, {"offset", {10, 20}}};
  const auto m = load(builder.write("texture_rotation")).scene.materials[0].base_color_texture.uv_transform;
  // (1, 0): scaled to (2, 0), turned to (0, -2). (0, 1): scaled to (0, 3), turned to (3, 0).
  const std::array<float, 6> expected{0, 3, 10, -2, 0, 20};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(m[i], expected[i], 1e-6) << i;
}

TEST(GltfMaterials, AllFieldsArrive) {
  GltfBuilder builder = textured({{"uri", white_pixel}});
  for (const char* name :
       {"KHR_materials_specular", "KHR_materials_ior", "KHR_materials_emissive_strength", "KHR_texture_transform"})
    builder.use_extension(name);
  builder.root["samplers"] = {{{"wrapS", 33648}, {"wrapT", 33071}, {"magFilter", 9728}}};
  builder.root["textures"][0]["sampler"] = 0;
  builder.root["materials"][0] = {
      {"name", "all"},
      {"pbrMetallicRoughness",
       {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
        {"baseColorTexture", {{"index", 0}, {"texCoord", 0}}},
        {"metallicFactor", 0.5},
        {"roughnessFactor", 0.6},
        {"metallicRoughnessTexture", {{"index", 0}}}}},
      {"emissiveFactor", {1, 0.5, 0}},
      {"emissiveTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"offset", {0.25, 0.75}}}}}}}},
      {"alphaMode", "MASK"},
      {"alphaCutoff", 0.7},
      {"doubleSided", true},
      {"extensions",
       {{"KHR_materials_specular",
         {{"specularFactor", 0.8}, {"specularColorFactor", {0.9, 2, 1}}, {"specularTexture", {{"index", 0}}}}},
        {"KHR_materials_ior", {{"ior", 1.33}}},
        {"KHR_materials_emissive_strength", {{"emissiveStrength", 40}}}}}};
  const Scene scene = load(builder.write("all_fields")).scene;
  const Material& m = scene.materials.at(0);
  EXPECT_EQ(m.base_color, Rgb(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(m.alpha, 0.4F);
  EXPECT_EQ(m.metallic, 0.5F);
  EXPECT_EQ(m.roughness, 0.6F);
  EXPECT_EQ(m.emission, Rgb(40, 20, 0));
  EXPECT_EQ(m.emission_texture.uv_transform, (std::array<float, 6>{1, 0, 0.25F, 0, 1, 0.75F}));
  EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(m.alpha_cutoff, 0.7F);
  EXPECT_TRUE(m.double_sided);
  EXPECT_EQ(m.specular, 0.8F);
  EXPECT_EQ(m.specular_color, Rgb(0.9F, 2, 1));
  EXPECT_EQ(m.specular_texture.texture, 0);
  EXPECT_EQ(m.specular_color_texture.texture, no_index);
  EXPECT_EQ(m.ior, 1.33F);
  EXPECT_FALSE(m.specular_glossiness);
  EXPECT_EQ(scene.textures[0].wrap_s, Wrap::mirrored_repeat);
  EXPECT_EQ(scene.textures[0].wrap_t, Wrap::clamp_to_edge);
  EXPECT_TRUE(scene.textures[0].nearest);
}

TEST(GltfMaterials, DefaultsAreThoseOfTheSpecification) {
  GltfBuilder builder;
  builder.root["materials"] = json::array({json::object()});
  const int mesh = builder.add_triangle_mesh();
  builder.root["meshes"][0]["primitives"][0]["material"] = 0;
  builder.add_node({{"mesh", mesh}});
  builder.add_node({{"mesh", builder.add_triangle_mesh()}});
  const Scene scene = load(builder.write("defaults")).scene;
  // The file's material, and the one behind it for primitives without any, are the same.
  ASSERT_EQ(scene.materials.size(), 2U);
  EXPECT_EQ(scene.meshes[1].material, 1);
  for (const Material& m : scene.materials) {
    EXPECT_EQ(m.base_color, Rgb(1, 1, 1));
    EXPECT_EQ(m.metallic, 1);
    EXPECT_EQ(m.roughness, 1);
    EXPECT_EQ(m.emission, Rgb(0, 0, 0));
    EXPECT_EQ(m.alpha_mode, AlphaMode::opaque);
    EXPECT_EQ(m.alpha_cutoff, 0.5F);
    EXPECT_FALSE(m.double_sided);
    EXPECT_EQ(m.ior, 1.5F);
  }
}

TEST(GltfMaterials, SpecularGlossiness) {
  GltfBuilder builder;
  builder.use_extension("KHR_materials_pbrSpecularGlossiness");
  builder.root["materials"] = {
      {{"extensions",
        {{"KHR_materials_pbrSpecularGlossiness",
          {{"diffuseFactor", {0.1, 0.2, 0.3, 0.5}}, {"specularFactor", {0.4, 0.5, 0.6}}, {"glossinessFactor", 0.7}}}}},
       {"alphaMode", "BLEND"}}};
  const int mesh = builder.add_triangle_mesh();
  builder.root["meshes"][0]["primitives"][0]["material"] = 0;
  builder.add_node({{"mesh", mesh}});
  const Material m = load(builder.write("spec_gloss")).scene.materials[0];
  EXPECT_TRUE(m.specular_glossiness);
  EXPECT_EQ(m.base_color, Rgb(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(m.alpha, 0.5F);
  EXPECT_EQ(m.specular_color, Rgb(0.4F, 0.5F, 0.6F));
  EXPECT_EQ(m.glossiness, 0.7F);
  EXPECT_EQ(m.alpha_mode, AlphaMode::blend);
}

TEST(GltfMaterials, SampleScenes) {
  const std::string folder = sample_data();
  if (folder.empty()) GTEST_SKIP() << no_sample_data;
  const Scene garden = load(folder + "/gltf/japanese_bridge_garden.glb").scene;
  EXPECT_EQ(garden.materials.size(), 14U);
  EXPECT_EQ(std::count_if(garden.materials.begin(), garden.materials.end(),
                          [](const Material& m) { return m.specular_glossiness; }),
            13);

  const LoadedScene cornell = load(folder + "/gltf/cornellbox_stratum/cornellbox.gltf");
  EXPECT_TRUE(has_warning(cornell, "emissive factor above 1"));
  EXPECT_EQ(material_named(cornell.scene, "Light").emission.x, 15);

  const Scene alpha = load(folder + "/gltf/AlphaBlendModeTest/glTF/AlphaBlendModeTest.gltf").scene;
  int masked = 0;
  int blended = 0;
  for (const Mesh& mesh : alpha.meshes) {
    const AlphaMode mode = alpha.materials[std::size_t(mesh.material)].alpha_mode;
    masked += mode == AlphaMode::mask ? 1 : 0;
    blended += mode == AlphaMode::blend ? 1 : 0;
  }
  // Three cutoffs of which the sample's note speaks, and one blended panel.
  EXPECT_EQ(masked, 3);
  EXPECT_GE(blended, 1);

  const Scene uv = load(folder + "/gltf/MultiUVTest/glTF/MultiUVTest.gltf").scene;
  EXPECT_EQ(uv.meshes[0].uvs.size(), 2U);
}

TEST(GltfMaterials, ATextureWithoutCoordinatesIsLeftOutOnce) {
  GltfBuilder builder = textured({{"uri", white_pixel}});
  builder.root["meshes"][0]["primitives"].push_back(builder.root["meshes"][0]["primitives"][0]);
  builder.root["meshes"][0]["primitives"][1]["attributes"].erase("TEXCOORD_0");
  const LoadedScene loaded = load(builder.write("no_coordinates"));
  EXPECT_TRUE(has_warning(loaded, "lacks TEXCOORD_0"));
  const Scene& scene = loaded.scene;
  EXPECT_EQ(scene.materials[std::size_t(scene.meshes[0].material)].base_color_texture.texture, 0);
  EXPECT_EQ(scene.materials[std::size_t(scene.meshes[1].material)].base_color_texture.texture, no_index);
}

TEST(GltfMaterials, TangentsFollowTheTexture) {
  // A quad facing +z whose u runs right and v runs down: tangent +x, bitangent (image up) +y.
  const auto build = [](const std::vector<V2f>& uvs, bool normals) {
    GltfBuilder builder;
    builder.root["images"] = {{{"uri", white_pixel}}};
    builder.root["textures"] = {{{"source", 0}}};
    builder.root["materials"] = {{{"normalTexture", {{"index", 0}, {"scale", 0.5}}}}};
    json attributes = {{"POSITION", builder.add({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}})},
                       {"TEXCOORD_0", builder.add(uvs)}};
    if (normals) attributes["NORMAL"] = builder.add({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
    builder.add_node({{"mesh", builder.add_mesh({{"attributes", attributes},
                                                 {"indices", builder.add_indices({0, 1, 2, 0, 2, 3})},
                                                 {"material", 0}})}});
    return builder;
  };
  Mesh mesh = load(build({{0, 1}, {1, 1}, {1, 0}, {0, 0}}, true).write("tangents")).scene.meshes.at(0);
  ASSERT_EQ(mesh.tangents.size(), 4U);
  for (const V4f& t : mesh.tangents) EXPECT_EQ(t, V4f(1, 0, 0, 1));

  // Mirrored in u: tangent -x; image up is still +y = cross(n, t) w, so w = -1.
  mesh = load(build({{1, 1}, {0, 1}, {0, 0}, {1, 0}}, true).write("tangents_mirrored")).scene.meshes.at(0);
  for (const V4f& t : mesh.tangents) EXPECT_EQ(t, V4f(-1, 0, 0, -1));

  // Stretched and turned by a quarter: u runs up, v runs right. Without normals each triangle gets its own.
  mesh = load(build({{0, 0}, {0, 1}, {5, 1}, {5, 0}}, false).write("tangents_flat")).scene.meshes.at(0);
  ASSERT_EQ(mesh.positions.size(), 6U);
  for (const V4f& t : mesh.tangents) EXPECT_EQ(t, V4f(0, 1, 0, 1));
  for (const V3f& n : mesh.normals) EXPECT_EQ(n, V3f(0, 0, 1));

  // One triangle mirrored against the other: the two vertices of the shared edge are split.
  mesh = load(build({{0, 1}, {1, 1}, {0, 0}, {1, 0.5}}, true).write("tangents_split")).scene.meshes.at(0);
  for (const auto& t : mesh.triangles) EXPECT_EQ(mesh.tangents[t.x].w, mesh.tangents[t.y].w);
  EXPECT_NE(mesh.tangents[mesh.triangles[0].x].w, mesh.tangents[mesh.triangles[1].x].w);
  EXPECT_EQ(mesh.positions.size(), 6U);
}

// An unlit dome around a lit square: the sun reaches it, and its box is the scene's. Emission that the file gives it
// besides is none either (KHR_materials_unlit).
TEST(GltfMaterials, UnlitSurfacesNeitherHideNorShine) {
  GltfBuilder builder;
  builder.use_extension("KHR_materials_unlit");
  builder.root["materials"] = {
      {{"name", "sky"}, {"emissiveFactor", {1, 1, 1}}, {"extensions", {{"KHR_materials_unlit", json::object()}}}}};
  const int ground = builder.add_triangle_mesh();
  const int dome = builder.add_triangle_mesh();
  builder.root["meshes"][std::size_t(dome)]["primitives"][0]["material"] = 0;
  builder.add_node({{"mesh", ground}});
  builder.add_node({{"mesh", dome}, {"scale", {100, 100, 1}}, {"translation", {-20, -20, 3}}});
  builder.add_node({{"mesh", dome}, {"scale", {100, 100, 1}}, {"translation", {-20, -20, -3}}});
  const LoadedScene loaded = load(builder, "dome");
  EXPECT_TRUE(has_warning(loaded, "materials[0] 'sky' is unlit"));
  EXPECT_TRUE(has_warning(loaded, "(2 triangles)"));
  EXPECT_EQ(loaded.warnings.size(), 1U);
  EXPECT_EQ(loaded.scene.instances.size(), 1U);
  EXPECT_EQ(bounds(loaded.scene).max, V3f(1, 1, 0));
  EXPECT_FALSE(make_lit_scene(loaded.scene).lights.has_extended());
  Ray up;
  up.origin = V3f(0.2F, 0.2F, 0.1F);
  up.direction = V3f(0, 0, 1);
  EXPECT_EQ(Intersector(loaded.scene).transmittance(up), 1);
}

}  // namespace
}  // namespace ivory
