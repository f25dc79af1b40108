// A glTF file after reading and checking: what the stages of load_gltf() share. Private to the loader.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <tiny_gltf.h>

namespace ivory::gltf {

// What to do about a file that breaks the specification.
inline constexpr const char* remedy = "export the file again, or check it with the Khronos glTF validator";

struct Document {
  Document();
  ~Document();
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  std::string path;
  bool is_glb = false;
  std::set<int> uv_sets;  // to read whether or not a texture asks for them
  // Checked by check_schema(): every property that ivory reads has its type and range, every index
  // its target. Extensions, images and buffers are read from here; the rest from `model`.
  std::unique_ptr<nlohmann::json> json;
  tinygltf::Model model;

  std::vector<std::vector<std::uint8_t>> storage;      // bytes that `buffers` and `views` point into
  std::vector<std::span<const std::uint8_t>> buffers;  // [buffer]; empty for a meshopt fallback without data
  std::vector<std::span<const std::uint8_t>> views;    // [bufferView], EXT_meshopt_compression undone
  std::uint64_t bytes_read = 0;                        // of all files: what the claims in them must be in proportion to
  std::uint64_t hash = 0;                              // of all bytes read so far
  std::vector<std::string> files;                      // that they came from

  std::vector<std::string> warnings;
  std::set<std::string> said;  // the same lines, to say each once

  // Throws Error; control characters that names from the file may bring in are replaced, so that
  // the message stays one line.
  [[noreturn]] void fail(const std::string& cause, const std::string& advice) const;
  void warn(const std::string& message);
};

// Reads the file (and, for GLB, its binary chunk), parses and checks the JSON.
void read_json(Document& document);
// Loads all buffers and resolves all buffer views. In buffers.cpp.
void read_buffers(Document& document);
// Hands what remains to tinygltf.
void parse_model(Document& document);

// The bytes of a file, or of a data: URI, named by a uri relative to the document, or to what it links to. Adds them to
// the hash. Uris that are no URIs but paths (with backslashes) or web addresses (with a query) are read with a warning.
// `what` names the user of the uri in messages.
std::vector<std::uint8_t> read_uri(Document& document, const std::string& uri, const std::string& what);

// Where a file of that name lies that belongs to the document: beside it, else, where that is a link, beside what it
// links to; beside it where there is none.
std::string path_beside(const Document& document, const std::string& name);

// json.extensions.name, or nullptr.
const nlohmann::json* find_extension(const nlohmann::json& object, const char* name);
// json[array][index]
const nlohmann::json& element(const Document& document, const char* array, std::size_t index);

// "meshes[3] 'wall'"
std::string label(const char* array, std::size_t index, const std::string& name);

}  // namespace ivory::gltf
