// Draco and meshopt: what comes out equals what went in.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "grid/base/error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/scene_check.h"
#include "tests/support/world_triangles.h"
#include "tracer/gltf/loader.h"

namespace ivory {
namespace {

using nlohmann::json;

TEST(GltfCompression, DracoBoxIsThePlainBox) {
  const std::string folder = sample_data();
  if (folder.empty()) GTEST_SKIP() << no_sample_data;
  const Scene plain = load_gltf(folder + "/gltf/Box/glTF/Box.gltf").scene;
  const Scene draco = load_gltf(folder + "/gltf/Box/glTF-Draco/Box.gltf").scene;
  EXPECT_EQ(find_fault(draco), "");
  const auto expected = world_triangles(plain);
  const auto found = world_triangles(draco);
  ASSERT_EQ(expected.size(), 12U);
  ASSERT_EQ(found.size(), expected.size());
  // Same triangles, up to Draco's quantization (11 bits and more over one metre) and another choice
  // of diagonal never: match each by its corners.
  for (const Corners& t : expected) {
    const bool matched = std::any_of(found.begin(), found.end(), [&t](const Corners& other) {
      // The smallest corner may differ after quantization: try all rotations.
      for (std::size_t shift = 0; shift < 3; ++shift) {
        float distance = 0;
        for (std::size_t c = 0; c < 3; ++c)
          for (std::size_t k = 0; k < 3; ++k)
            distance = std::max(distance, std::abs(t[c][k] - other[(c + shift) % 3][k]));
        if (distance < 1e-3F) return true;
      }
      return false;
    });
    EXPECT_TRUE(matched);
  }
  // Normals came through as well: each vertex's equals its triangle's.
  for (const Mesh& mesh : draco.meshes) {
    ASSERT_FALSE(mesh.normals.empty());
    for (const auto& t : mesh.triangles) {
      const V3f ng =
          (mesh.positions[t.y] - mesh.positions[t.x]).cross(mesh.positions[t.z] - mesh.positions[t.x]).normalized();
      EXPECT_GT(ng.dot(mesh.normals[t.x]), 0.99F);
    }
  }
}

// A bumpy sheet, whose triangles the codecs have something to do with.
struct Sheet {
  std::vector<V3f> positions;
  std::vector<std::uint32_t> indices;
};
Sheet make_sheet(int side) {
  Sheet sheet;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> height(0, 0.1F);
  for (int y = 0; y <= side; ++y)
    for (int x = 0; x <= side; ++x) sheet.positions.emplace_back(float(x), height(random), float(y));
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const std::uint32_t i = std::uint32_t(y * (side + 1) + x);
      const std::uint32_t down = i + std::uint32_t(side) + 1;
      sheet.indices.insert(sheet.indices.end(), {i, down, i + 1, i + 1, down, down + 1});
    }
  }
  return sheet;
}

// Compresses `data` into the builder's buffer; the view itself stands in a second buffer that has
// no bytes at all (the fallback buffer of the extension).
int add_compressed_view(GltfBuilder& builder, const std::vector<unsigned char>& data, std::size_t count,
                        std::size_t stride, const char* mode, const char* filter = nullptr) {
  const int hidden = builder.add_view(data.data(), data.size());
  json& view = builder.root["bufferViews"][std::size_t(hidden)];
  json extension = {{"buffer", 0},
                    {"byteOffset", view["byteOffset"]},
                    {"byteLength", data.size()},
                    {"byteStride", stride},
                    {"count", count},
                    {"mode", mode}};
  if (filter != nullptr) extension["filter"] = filter;
  view = {{"buffer", 1},
          {"byteOffset", 0},
          {"byteLength", count * stride},
          {"extensions", {{"EXT_meshopt_compression", extension}}}};
  if (std::string(mode) == "ATTRIBUTES") view["byteStride"] = stride;
  return hidden;
}

std::string write_with_fallback(const GltfBuilder& builder, const std::string& name) {
  json root = builder.root;
  root["buffers"] = {{{"byteLength", builder.bytes.size()}},
                     {{"byteLength", 1 << 20}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  const std::string path = GltfBuilder::folder() + "/" + name + ".glb";
  GltfBuilder::write_file(path, GltfBuilder::glb(root.dump(), std::string(builder.bytes.begin(), builder.bytes.end())));
  return path;
}

TEST(GltfCompression, MeshoptCompressionIsUndone) {
  const Sheet sheet = make_sheet(20);
  const std::size_t vertices = sheet.positions.size();
  std::vector<unsigned char> packed_vertices(meshopt_encodeVertexBufferBound(vertices, 12));
  packed_vertices.resize(
      meshopt_encodeVertexBuffer(packed_vertices.data(), packed_vertices.size(), sheet.positions.data(), vertices, 12));
  std::vector<unsigned char> packed_triangles(meshopt_encodeIndexBufferBound(sheet.indices.size(), vertices));
  packed_triangles.resize(meshopt_encodeIndexBuffer(packed_triangles.data(), packed_triangles.size(),
                                                    sheet.indices.data(), sheet.indices.size()));
  std::vector<unsigned char> packed_sequence(meshopt_encodeIndexSequenceBound(sheet.indices.size(), vertices));
  packed_sequence.resize(meshopt_encodeIndexSequence(packed_sequence.data(), packed_sequence.size(),
                                                     sheet.indices.data(), sheet.indices.size()));

  GltfBuilder plain;
  const int plain_positions = plain.add(sheet.positions);
  const int plain_indices = plain.add_accessor("SCALAR", 5125, sheet.indices.size(),
                                               plain.add_view(sheet.indices.data(), sheet.indices.size() * 4));
  plain.add_node(
      {{"mesh", plain.add_mesh({{"attributes", {{"POSITION", plain_positions}}}, {"indices", plain_indices}})}});
  const auto expected = world_triangles(load_gltf(plain.write("sheet")).scene);
  ASSERT_EQ(expected.size(), 800U);

  for (const char* mode : {"TRIANGLES", "INDICES"}) {
    GltfBuilder builder;
    builder.use_extension("EXT_meshopt_compression");
    const int positions = builder.add_accessor(
        "VEC3", 5126, vertices, add_compressed_view(builder, packed_vertices, vertices, 12, "ATTRIBUTES"));
    const auto& packed = mode == std::string("TRIANGLES") ? packed_triangles : packed_sequence;
    const int indices = builder.add_accessor("SCALAR", 5125, sheet.indices.size(),
                                             add_compressed_view(builder, packed, sheet.indices.size(), 4, mode));
    builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}})}});
    const LoadedScene loaded = load_gltf(write_with_fallback(builder, std::string("meshopt_") + mode));
    EXPECT_EQ(find_fault(loaded.scene), "");
    EXPECT_EQ(world_triangles(loaded.scene), expected) << mode;
  }
}

TEST(GltfCompression, MeshoptFiltersAreUndone) {
  // Positions through the exponential filter (15 bits), normals through the octahedral one (8 bits).
  const std::vector<V3f> positions{{0, 0, 0}, {1.25F, 0, 0}, {0, -3.5F, 0.125F}};
  const std::vector<V4f> normals{{0.6F, 0, 0.8F, 0}, {0, 0, -1, 0}, {-0.48F, 0.6F, 0.64F, 0}};
  std::vector<std::uint32_t> exponential(9);
  meshopt_encodeFilterExp(exponential.data(), 3, 12, 15, &positions[0].x);
  std::vector<std::int8_t> octahedral(12);
  meshopt_encodeFilterOct(octahedral.data(), 3, 4, 8, &normals[0].x);
  std::vector<unsigned char> packed_positions(meshopt_encodeVertexBufferBound(3, 12));
  packed_positions.resize(
      meshopt_encodeVertexBuffer(packed_positions.data(), packed_positions.size(), exponential.data(), 3, 12));
  std::vector<unsigned char> packed_normals(meshopt_encodeVertexBufferBound(3, 4));
  packed_normals.resize(
      meshopt_encodeVertexBuffer(packed_normals.data(), packed_normals.size(), octahedral.data(), 3, 4));

  GltfBuilder builder;
  builder.use_extension("EXT_meshopt_compression");
  const int p = builder.add_accessor(
      "VEC3", 5126, 3, add_compressed_view(builder, packed_positions, 3, 12, "ATTRIBUTES", "EXPONENTIAL"));
  const int n = builder.add_accessor(
      "VEC3", 5120, 3, add_compressed_view(builder, packed_normals, 3, 4, "ATTRIBUTES", "OCTAHEDRAL"), true);
  builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", p}, {"NORMAL", n}}}})}});
  const LoadedScene loaded = load_gltf(write_with_fallback(builder, "meshopt_filters"));
  const Mesh& mesh = loaded.scene.meshes.at(0);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((mesh.positions[i] - positions[i]).length(), 3.5F / 16384);                          // 15 bits with sign
    EXPECT_LT((mesh.normals[i] - V3f(normals[i].x, normals[i].y, normals[i].z)).length(), 0.02F);  // 1/127 a component
  }
}

TEST(GltfCompression, DamagedCompressionIsRefused) {
  const Sheet sheet = make_sheet(4);
  const std::size_t vertices = sheet.positions.size();
  std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(vertices, 12));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), sheet.positions.data(), vertices, 12));
  const auto error = [&](const std::vector<unsigned char>& data, std::size_t count) -> std::string {
    GltfBuilder builder;
    builder.use_extension("EXT_meshopt_compression");
    const int p =
        builder.add_accessor("VEC3", 5126, count, add_compressed_view(builder, data, count, 12, "ATTRIBUTES"));
    builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", p}}}})}});
    try {
      json root = builder.root;
      root["buffers"] = {{{"byteLength", builder.bytes.size()}}, {{"byteLength", std::uint64_t(1) << 40U}}};
      const std::string path = GltfBuilder::folder() + "/meshopt_bad.glb";
      GltfBuilder::write_file(path,
                              GltfBuilder::glb(root.dump(), std::string(builder.bytes.begin(), builder.bytes.end())));
      load_gltf(path);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(error(std::vector<unsigned char>(packed.begin(), packed.end() - 5), vertices).find("damaged meshopt"),
            std::string::npos);
  // A kilobyte that claims to be 12 GB.
  EXPECT_NE(error(packed, 1000000000).find("claims to unpack"), std::string::npos);
}

}  // namespace
}  // namespace ivory
