// Buffers and buffer views: where the bytes are, and EXT_meshopt_compression undone.
#include <OpenImageIO/hash.h>
#include <fmt/format.h>
#include <meshoptimizer.h>
#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>

#include "tracer/gltf/document.h"

namespace ivory::gltf {
namespace {

using nlohmann::json;

constexpr const char* damaged = "the file is damaged; export it again";

std::span<const std::uint8_t> part(const Document& document, const json& view, const std::string& what) {
  const std::size_t buffer = view["buffer"];
  const std::uint64_t offset = view.value("byteOffset", std::uint64_t{0});
  const std::uint64_t length = view["byteLength"];
  const std::uint64_t size = element(document, "buffers", buffer)["byteLength"];
  if (offset > size || length > size - offset)
    document.fail(fmt::format("{} ends {} bytes behind its buffer", what, offset + length - size), damaged);
  // A placeholder: whoever needs the view says that it has no data.
  if (document.buffers[buffer].empty()) return {};
  return document.buffers[buffer].subspan(offset, length);
}

struct CompressedView {
  std::size_t view;
  std::span<const std::uint8_t> source;
  std::size_t count;
  std::size_t stride;
  std::string mode;
  std::string filter;
};

CompressedView check_compressed(const Document& document, std::size_t index, const json& view, const json& extension) {
  const std::string what = fmt::format("bufferViews[{}]", index);
  CompressedView result{index,
                        part(document, extension, what + " (EXT_meshopt_compression)"),
                        extension["count"],
                        extension["byteStride"],
                        extension["mode"],
                        extension.value("filter", std::string("NONE"))};
  const std::size_t count = result.count;
  const std::size_t stride = result.stride;
  if (result.source.empty()) document.fail(what + " has no compressed data", damaged);
  const bool attributes = result.mode == "ATTRIBUTES";
  if (attributes ? stride % 4 != 0 : stride != 2 && stride != 4)
    document.fail(fmt::format("{} is compressed with a stride of {} bytes", what, stride), damaged);
  if (result.mode == "TRIANGLES" && count % 3 != 0) document.fail(what + " holds a part of a triangle", damaged);
  const bool filter_fits = result.filter == "NONE" || (attributes && (result.filter == "EXPONENTIAL" ||
                                                                      (result.filter == "QUATERNION" && stride == 8) ||
                                                                      (result.filter == "OCTAHEDRAL" && stride <= 8)));
  if (!filter_fits)
    document.fail(fmt::format("{} has filter {} where it does not apply", what, result.filter), damaged);
  if (count * stride != view["byteLength"].get<std::uint64_t>())
    document.fail(what + " has a byteLength other than count x byteStride", damaged);
  // The vertex codec spends at least two bits on sixteen bytes, the index codecs a byte on three
  // indices: what claims to be more is not worth trying (and would not fit into memory).
  if (count * stride > 64 * result.source.size() + 65536)
    document.fail(what + " claims to unpack to more than its compressed bytes can hold", damaged);
  return result;
}

bool decode(const CompressedView& view, std::vector<std::uint8_t>& out) {
  out.resize(view.count * view.stride);
  if (view.mode == "TRIANGLES")
    return meshopt_decodeIndexBuffer(out.data(), view.count, view.stride, view.source.data(), view.source.size()) == 0;
  if (view.mode == "INDICES") {
    return meshopt_decodeIndexSequence(out.data(), view.count, view.stride, view.source.data(), view.source.size()) ==
           0;
  }
  if (meshopt_decodeVertexBuffer(out.data(), view.count, view.stride, view.source.data(), view.source.size()) != 0)
    return false;
  if (view.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), view.count, view.stride);
  if (view.filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), view.count, view.stride);
  if (view.filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), view.count, view.stride);
  return true;
}

}  // namespace

void read_buffers(Document& document) {
  const std::span<const std::uint8_t> glb_data = document.buffers.front();
  document.buffers.clear();
  const json& root = *document.json;
  const json none = json::array();

  const auto buffers = root.find("buffers");
  for (const json& buffer : buffers == root.end() ? none : *buffers) {
    const std::size_t index = document.buffers.size();
    const std::string what = fmt::format("buffers[{}]", index);
    const std::uint64_t length = buffer["byteLength"];
    std::span<const std::uint8_t> bytes;
    if (buffer.contains("uri")) {
      document.storage.push_back(read_uri(document, buffer["uri"].get_ref<const std::string&>(), what));
      bytes = document.storage.back();
    } else if (index == 0) {
      bytes = glb_data;
    }
    if (bytes.empty() && !buffer.contains("uri")) {
      // Filled by an extension, or never; whoever needs it says so. The first of a GLB has no excuse.
      if (index == 0 && document.is_glb && find_extension(buffer, "EXT_meshopt_compression") == nullptr)
        document.fail(what + " should be the binary chunk, which the GLB lacks", damaged);
      document.buffers.emplace_back();
      continue;
    }
    if (length > bytes.size())
      document.fail(fmt::format("{} says {} bytes but has {}", what, length, bytes.size()), damaged);
    document.buffers.push_back(bytes.first(length));
  }

  std::vector<CompressedView> compressed;
  const auto views = root.find("bufferViews");
  for (const json& view : views == root.end() ? none : *views) {
    const std::size_t index = document.views.size();
    document.views.push_back(part(document, view, fmt::format("bufferViews[{}]", index)));
    if (const json* extension = find_extension(view, "EXT_meshopt_compression"))
      compressed.push_back(check_compressed(document, index, view, *extension));
  }

  std::vector<std::vector<std::uint8_t>> decoded(compressed.size());
  std::vector<char> good(compressed.size());
  tbb::parallel_for(std::size_t{0}, compressed.size(),
                    [&](std::size_t i) { good[i] = decode(compressed[i], decoded[i]) ? 1 : 0; });
  for (std::size_t i = 0; i < compressed.size(); ++i) {
    if (good[i] == 0)
      document.fail(fmt::format("bufferViews[{}] has damaged meshopt data", compressed[i].view), damaged);
    document.storage.push_back(std::move(decoded[i]));
    document.views[compressed[i].view] = document.storage.back();
  }
}

}  // namespace ivory::gltf
