#include "tracer/gltf/document.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <OpenImageIO/hash.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "tracer/gltf/uri.h"

namespace ivory::gltf {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::uint32_t glb_magic = 0x46546C67;   // "glTF"
constexpr std::uint32_t json_chunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t bin_chunk = 0x004E4942;   // "BIN\0"
// Far beyond what any exporter nests; recursion over the JSON stays shallow.
constexpr int max_json_depth = 128;

// Names and excerpts from the file may be of any length.
std::string clipped(const std::string& text) {
  constexpr std::size_t longest = 400;
  return text.size() <= longest ? text : text.substr(0, longest) + "...";
}

std::uint32_t read_u32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return std::uint32_t(bytes[at]) | std::uint32_t(bytes[at + 1]) << 8U | std::uint32_t(bytes[at + 2]) << 16U |
         std::uint32_t(bytes[at + 3]) << 24U;
}

void add_to_hash(Document& document, std::span<const std::uint8_t> bytes) {
  document.hash = OIIO::xxhash::XXH64(bytes.data(), bytes.size(), document.hash);
  document.bytes_read += bytes.size();
}

// Empty cause: read. Otherwise why not.
std::string read_file(const fs::path& path, std::vector<std::uint8_t>& bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return "no such file";
  // A pipe or a device would never end.
  if (!fs::is_regular_file(status)) return "not a regular file";
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) return error.message();
  std::ifstream in(path, std::ios::binary);
  if (!in) return "cannot be opened";
  bytes.resize(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (in.gcount() != static_cast<std::streamsize>(size)) return "cannot be read to its end";
  return "";
}

struct GlbChunks {
  std::span<const std::uint8_t> json;
  std::span<const std::uint8_t> bin;
};

// glTF 2.0, section 4.4: a 12 byte header, then chunks of length, type, data.
GlbChunks split_glb(Document& document, std::span<const std::uint8_t> file) {
  const char* const damaged = "the file is damaged; export it again";
  if (file.size() < 12) document.fail("GLB header is cut off", damaged);
  const std::uint32_t version = read_u32(file, 4);
  const std::uint32_t length = read_u32(file, 8);
  if (version != 2) document.fail(fmt::format("GLB version is {}", version), "ivory reads version 2; export it again");
  if (length > file.size()) document.fail(fmt::format("GLB says {} bytes but has {}", length, file.size()), damaged);
  if (length < 12 + 8) document.fail(fmt::format("GLB says {} bytes, too few for any chunk", length), damaged);
  if (length < file.size())
    document.warn(fmt::format("{} bytes behind the end of the GLB are ignored", file.size() - length));

  GlbChunks chunks;
  std::size_t at = 12;
  for (int number = 0; at < length; ++number) {
    if (length - at < 8) document.fail("GLB chunk header is cut off", damaged);
    const std::uint32_t size = read_u32(file, at);
    const std::uint32_t type = read_u32(file, at + 4);
    at += 8;
    if (size > length - at) document.fail(fmt::format("GLB chunk {} is cut off", number), damaged);
    if (size % 4 != 0) document.fail(fmt::format("GLB chunk {} has a length that 4 does not divide", number), damaged);
    const auto data = file.subspan(at, size);
    at += size;
    if (number == 0) {
      if (type != json_chunk) document.fail("first GLB chunk is not JSON", damaged);
      chunks.json = data;
    } else if (type == json_chunk) {
      document.fail("GLB has two JSON chunks", damaged);
    } else if (type == bin_chunk) {
      if (number != 1) document.fail("GLB has a binary chunk that is not its second", damaged);
      chunks.bin = data;
    } else {
      document.warn(fmt::format("GLB chunk {} of unknown type is ignored", number));
    }
  }
  return chunks;
}

// Deepest nesting of brackets outside strings. The parser's own callback could tell as well, at a
// cost that grows with the square of the longest array.
int nesting(std::span<const std::uint8_t> text) {
  int depth = 0;
  int deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = static_cast<char>(text[i]);
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return deepest;
}

json parse(const Document& document, std::span<const std::uint8_t> text) {
  if (nesting(text) > max_json_depth)
    document.fail(fmt::format("JSON is nested deeper than {} levels", max_json_depth), "the file is damaged");
  try {
    return json::parse(text.begin(), text.end());
  } catch (const json::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 1, ..."
    const std::string cause = error.what();
    document.fail("is not JSON: " + cause.substr(std::min(cause.find("] ") + 2, cause.size())),
                  "the file is damaged or of another kind");
  }
}

// Where a file's companions may lie: beside it, and beside what it links to.
std::vector<fs::path> folders_of(const Document& document) {
  std::vector<fs::path> folders{fs::path(document.path).parent_path()};
  std::error_code error;
  const fs::path target = fs::canonical(document.path, error);
  if (!error && fs::is_symlink(document.path, error)) folders.push_back(target.parent_path());
  return folders;
}

// A file that a uri may mean, and what had to be mended in the uri for it.
struct Candidate {
  fs::path path;
  std::string mended;  // empty: nothing
};

// First as a URI says it (relative, with %xx), then as exporters write it: with the unescaped name, Windows'
// separators, and the query of a web address.
std::vector<Candidate> candidates(const Document& document, const std::string& uri) {
  const std::vector<fs::path> folders = folders_of(document);
  const std::string bare = uri.substr(0, uri.find_first_of("?#"));
  const auto with_slashes = [](std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    return name;
  };
  struct Spelling {
    std::string name;
    const char* mended;
  };
  const Spelling spellings[] = {
      {percent_decoded(uri), ""},
      {uri, ""},
      {with_slashes(percent_decoded(uri)), "with slashes for its backslashes"},
      {percent_decoded(bare), "without its query"},
      {with_slashes(percent_decoded(bare)), "without its query, with slashes for its backslashes"}};
  std::vector<Candidate> result;
  for (const Spelling& spelling : spellings) {
    for (const fs::path& folder : folders)
      if (!spelling.name.empty()) result.push_back({folder / fs::path(spelling.name), spelling.mended});
  }
  return result;
}

void drop_extras(json& value) {
  if (value.is_object()) {
    value.erase("extensions");
    value.erase("extras");
  }
  if (value.is_structured())
    for (json& child : value) drop_extras(child);
}

}  // namespace

Document::Document() = default;
Document::~Document() = default;

void Document::fail(const std::string& cause, const std::string& advice) const {
  throw Error(path, clipped(cause), advice);
}

void Document::warn(const std::string& message) {
  std::string line = in_one_line(path + ": " + clipped(message));
  if (said.insert(line).second) warnings.push_back(std::move(line));
}

void read_json(Document& document) {
  std::vector<std::uint8_t> file;
  const std::string cause = read_file(document.path, file);
  if (!cause.empty()) document.fail(cause, "check the name");
  add_to_hash(document, file);
  document.files.push_back(document.path);
  if (file.empty()) document.fail("is empty", "export it again");

  document.storage.push_back(std::move(file));
  const std::span<const std::uint8_t> bytes = document.storage.front();
  document.is_glb = bytes.size() >= 4 && read_u32(bytes, 0) == glb_magic;
  GlbChunks chunks{bytes, {}};
  if (document.is_glb) chunks = split_glb(document, bytes);
  document.json = std::make_unique<json>(parse(document, chunks.json));
  document.buffers.push_back(chunks.bin);
}

// Buffers and images are read by ivory (tinygltf trusts the views that images name, and knows neither meshopt's
// placeholder buffers nor accessors without a view as indices), so they and everything that ivory does not need are
// left out.
void parse_model(Document& document) {
  json copy = json::object();
  for (const char* name : {"asset", "accessors", "bufferViews", "cameras", "materials", "meshes", "nodes", "samplers",
                           "scene", "scenes", "textures"}) {
    const auto found = document.json->find(name);
    if (found != document.json->end()) copy[name] = *found;
  }
  drop_extras(copy);
  // tinygltf wants a view for every accessor of indices.
  const int no_view = copy.contains("bufferViews") ? int(copy["bufferViews"].size()) : 0;
  copy["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 1}});
  if (copy.contains("accessors")) {
    for (json& accessor : copy["accessors"])
      if (!accessor.contains("bufferView")) accessor["bufferView"] = no_view;
  }

  const std::string text = copy.dump();
  tinygltf::TinyGLTF parser;
  std::string errors;
  std::string warnings;
  bool parsed = false;
  if (text.size() < (std::size_t{1} << 31U)) {
    try {
      parsed = parser.LoadASCIIFromString(&document.model, &errors, &warnings, text.data(), unsigned(text.size()), "");
    } catch (const std::exception& error) {
      errors += error.what();
    }
  }
  if (!parsed) document.fail("cannot be understood: " + errors, "export it again");
  document.model.bufferViews.pop_back();
  for (tinygltf::Accessor& accessor : document.model.accessors)
    if (accessor.bufferView == no_view) accessor.bufferView = -1;
}

std::vector<std::uint8_t> read_uri(Document& document, const std::string& uri, const std::string& what) {
  if (is_data_uri(uri)) return decode_data_uri(document, uri, what);
  // A scheme, or a drive.
  const std::size_t colon = uri.find(':');
  if (colon != std::string::npos && colon < uri.find_first_of("/\\?#"))
    document.fail(what + " lies at " + uri, "ivory reads files and data URIs only; store it beside the glTF file");
  const std::vector<Candidate> files = candidates(document, uri);
  std::error_code error;
  auto found =
      std::ranges::find_if(files, [&](const Candidate& file) { return fs::is_regular_file(file.path, error); });
  if (found == files.end()) found = files.begin();  // whose absence is said
  const std::string file = found == files.end() ? fs::path(document.path).parent_path().string() : found->path.string();
  std::vector<std::uint8_t> bytes;
  const std::string cause = read_file(file, bytes);
  if (!cause.empty()) document.fail(what + " needs " + file + ": " + cause, "put it there, or export again");
  if (!found->mended.empty())
    document.warn(fmt::format("{} is called '{}', which is no file; {} is read, {}", what, uri, file, found->mended));
  add_to_hash(document, bytes);
  document.files.push_back(file);
  return bytes;
}

std::string path_beside(const Document& document, const std::string& name) {
  const std::vector<fs::path> folders = folders_of(document);
  std::error_code error;
  for (const fs::path& folder : folders)
    if (fs::exists(folder / name, error)) return (folder / name).string();
  return (folders.front() / name).string();
}

const json* find_extension(const json& object, const char* name) {
  if (!object.is_object()) return nullptr;
  const auto extensions = object.find("extensions");
  if (extensions == object.end() || !extensions->is_object()) return nullptr;
  const auto found = extensions->find(name);
  return found == extensions->end() ? nullptr : &*found;
}

const json& element(const Document& document, const char* array, std::size_t index) {
  return (*document.json)[array][index];
}

std::string label(const char* array, std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{}[{}]", array, index) : fmt::format("{}[{}] '{}'", array, index, name);
}

}  // namespace ivory::gltf
