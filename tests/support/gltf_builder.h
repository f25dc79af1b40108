// Small glTF documents written by tests.
#pragma once

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "grid/base/types.h"
#include "tests/support/paths.h"

namespace ivory {

struct GltfBuilder {
  nlohmann::json root = {
      {"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", nlohmann::json::array()}}}}};
  std::vector<std::uint8_t> bytes;

  int add_view(const void* data, std::size_t size, int stride = 0) {
    while (bytes.size() % 4 != 0) bytes.push_back(0);
    nlohmann::json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", size}};
    if (stride != 0) view["byteStride"] = stride;
    const auto* first = static_cast<const std::uint8_t*>(data);
    bytes.insert(bytes.end(), first, first + size);
    root["bufferViews"].push_back(view);
    return int(root["bufferViews"].size()) - 1;
  }
  int add_accessor(const char* type, int component_type, std::size_t count, int view, bool normalized = false) {
    nlohmann::json accessor = {{"type", type}, {"componentType", component_type}, {"count", count}};
    if (view >= 0) accessor["bufferView"] = view;
    if (normalized) accessor["normalized"] = true;
    root["accessors"].push_back(accessor);
    return int(root["accessors"].size()) - 1;
  }
  int add(const std::vector<V2f>& v) { return add_accessor("VEC2", 5126, v.size(), add_view(v.data(), v.size() * 8)); }
  int add(const std::vector<V3f>& v) { return add_accessor("VEC3", 5126, v.size(), add_view(v.data(), v.size() * 12)); }
  int add(const std::vector<V4f>& v) { return add_accessor("VEC4", 5126, v.size(), add_view(v.data(), v.size() * 16)); }
  int add_indices(const std::vector<std::uint16_t>& v) {
    return add_accessor("SCALAR", 5123, v.size(), add_view(v.data(), v.size() * 2));
  }
  int add_mesh(const nlohmann::json& primitive) {
    root["meshes"].push_back({{"primitives", {primitive}}});
    return int(root["meshes"].size()) - 1;
  }
  // Nodes stand in the scene unless they are children.
  int add_node(const nlohmann::json& node, bool in_scene = true) {
    root["nodes"].push_back(node);
    const int index = int(root["nodes"].size()) - 1;
    if (in_scene) root["scenes"][0]["nodes"].push_back(index);
    return index;
  }
  // One triangle in the xy plane, front towards +z.
  int add_triangle_mesh() { return add_mesh({{"attributes", {{"POSITION", add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})}}}}); }
  void use_extension(const char* name) { root["extensionsUsed"].push_back(name); }

  // One for each test, as tests may run side by side.
  static std::string folder() {
    const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(test->test_suite_name()) + "_" + test->name();
    std::replace(name.begin(), name.end(), '/', '_');
    const std::string path = std::string(output_folder) + "/" + name;
    std::filesystem::create_directories(path);
    return path;
  }
  static void write_file(const std::string& path, const std::string& content) {
    // Truncating an existing file makes some file systems wait for the disk at each close.
    std::filesystem::remove(path);
    std::ofstream(path, std::ios::binary) << content;
  }
  static std::string glb(const std::string& json_text, const std::string& binary) {
    const auto word = [](std::size_t value) {
      const auto number = std::uint32_t(value);
      std::string text(4, '\0');
      std::memcpy(text.data(), &number, 4);
      return text;
    };
    std::string text = json_text;
    while (text.size() % 4 != 0) text += ' ';
    std::string data = binary;
    while (data.size() % 4 != 0) data += '\0';
    std::string chunks = word(text.size()) + "JSON" + text;
    if (!data.empty()) chunks += word(data.size()) + std::string("BIN\0", 4) + data;
    return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
  }
  // Writes a GLB into the tests' folder and returns its path.
  std::string write(const std::string& name) const {
    nlohmann::json copy = root;
    if (!bytes.empty()) copy["buffers"].push_back({{"byteLength", bytes.size()}});
    const std::string path = folder() + "/" + name + ".glb";
    write_file(path, glb(copy.dump(), std::string(bytes.begin(), bytes.end())));
    return path;
  }
};

}  // namespace ivory
