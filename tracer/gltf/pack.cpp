#include "tracer/gltf/pack.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tracer/gltf/document.h"
#include "tracer/gltf/schema/check.h"

namespace ivory {

namespace {

using nlohmann::json;

constexpr const char* meshopt = "EXT_meshopt_compression";
constexpr std::size_t alignment = 8;  // of the largest component that an accessor has, and of Draco's readers

std::string media_type(std::span<const std::uint8_t> bytes) {
  const auto begins_with = [&](std::string_view magic, std::size_t at = 0) {
    return bytes.size() >= at + magic.size() &&
           std::equal(magic.begin(), magic.end(), bytes.begin() + std::ptrdiff_t(at),
                      [](char a, std::uint8_t b) { return std::uint8_t(a) == b; });
  };
  if (begins_with("\x89PNG")) return "image/png";
  if (begins_with("\xFF\xD8")) return "image/jpeg";
  if (begins_with("WEBP", 8)) return "image/webp";
  if (begins_with("\xABKTX 20")) return "image/ktx2";
  return {};
}

class Binary {
 public:
  // Where they lie.
  std::size_t add(std::span<const std::uint8_t> bytes) {
    bytes_.resize((bytes_.size() + alignment - 1) / alignment * alignment, '\0');
    const std::size_t offset = bytes_.size();
    bytes_.append(bytes.begin(), bytes.end());
    return offset;
  }
  std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

void drop_from_list(json& root, const char* list, const char* name) {
  const auto found = root.find(list);
  if (found == root.end()) return;
  found->erase(std::remove(found->begin(), found->end(), name), found->end());
  if (found->empty()) root.erase(found);
}

void pack_views(const gltf::Document& document, json& root, Binary& binary) {
  if (!root.contains("bufferViews")) return;
  json& views = root["bufferViews"];
  for (std::size_t i = 0; i < views.size(); ++i) {
    json& view = views[i];
    const std::span<const std::uint8_t> data = document.views[i];
    if (const auto extensions = view.find("extensions"); extensions != view.end()) {
      extensions->erase(meshopt);
      if (extensions->empty()) view.erase(extensions);
    }
    view["buffer"] = 0;
    view["byteOffset"] = binary.add(data);
    // A view of a placeholder buffer holds nothing; nobody may read it, but it must not be empty.
    if (data.empty()) {
      const std::vector<std::uint8_t> nothing(view["byteLength"].get<std::size_t>(), 0);
      view["byteOffset"] = binary.add(nothing);
    } else {
      view["byteLength"] = data.size();
    }
  }
}

void pack_images(gltf::Document& document, json& root, Binary& binary) {
  if (!root.contains("images")) return;
  json& images = root["images"];
  for (std::size_t i = 0; i < images.size(); ++i) {
    json& image = images[i];
    if (!image.contains("uri")) continue;
    const std::vector<std::uint8_t> bytes =
        gltf::read_uri(document, image["uri"].get<std::string>(), fmt::format("images[{}]", i));
    const std::string type = media_type(bytes);
    if (!type.empty()) image["mimeType"] = type;
    if (!image.contains("mimeType"))
      document.fail(fmt::format("images[{}] is of no kind that a .glb can hold", i), "store it as PNG or JPEG");
    root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.add(bytes)}, {"byteLength", bytes.size()}});
    image.erase("uri");
    image["bufferView"] = root["bufferViews"].size() - 1;
  }
}

}  // namespace

PackedScene pack_glb(const std::string& path) {
  gltf::Document document;
  document.path = path;
  gltf::read_json(document);
  gltf::check_schema(document);
  gltf::check_extensions(document);
  gltf::read_buffers(document);
  json root = *document.json;
  Binary binary;
  pack_views(document, root, binary);
  pack_images(document, root, binary);
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) drop_from_list(root, list, meshopt);
  std::string& data = binary.bytes();
  root.erase("buffers");
  if (!data.empty()) root["buffers"] = {{{"byteLength", data.size()}}};
  data.resize((data.size() + 3) / 4 * 4, '\0');
  std::string text = root.dump(-1, ' ', false, json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');

  const std::size_t whole = 12 + 8 + text.size() + (data.empty() ? 0 : 8 + data.size());
  if (whole > std::numeric_limits<std::uint32_t>::max())
    document.fail("has more than the 4 GB that a .glb holds", "leave out what is not shown");
  PackedScene packed;
  const auto put_word = [&](std::size_t word) {
    for (unsigned shift = 0; shift < 32; shift += 8) packed.bytes.push_back(char(word >> shift & 0xFFU));
  };
  packed.bytes.reserve(whole);
  for (const std::size_t word : {std::size_t{0x46546C67}, std::size_t{2}, whole}) put_word(word);  // "glTF"
  put_word(text.size());
  packed.bytes += "JSON";
  packed.bytes += text;
  if (!data.empty()) {
    put_word(data.size());
    packed.bytes += std::string("BIN\0", 4);
    packed.bytes += data;
  }
  if (root.contains("extensionsUsed"))
    packed.needs_draco = root["extensionsUsed"].dump().find("KHR_draco_mesh_compression") != std::string::npos;
  packed.warnings = std::move(document.warnings);
  return packed;
}

}  // namespace ivory
