#include "tracer/gltf/draco.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wconversion"
#endif
#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace ivory::gltf {
namespace {

constexpr const char* without_draco = "export the file again, or without Draco compression";

// Vertices and faces that the header claims. Draco allocates by them before it reads on, so they
// must be believable first. Layout: Draco bitstream specification, "Draco decoder", "Decode header",
// "Decode metadata", and the connectivity headers of the sequential and edgebreaker encoders.
// Nothing for streams older than 2.2, which store them otherwise.
struct ClaimedSize {
  std::uint32_t vertices = 0;
  std::uint32_t faces = 0;
};

std::optional<ClaimedSize> read_claimed_size(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t header_bytes = 11;
  if (bytes.size() < header_bytes + 2) return std::nullopt;
  const int version = bytes[5] * 10 + bytes[6];
  const bool edgebreaker = bytes[8] == 1;
  const bool has_metadata = (bytes[10] & 0x80U) != 0;
  if (version < 22) return std::nullopt;
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()) + header_bytes, bytes.size() - header_bytes,
              std::uint16_t(bytes[5] << 8U | bytes[6]));
  if (has_metadata) {
    draco::GeometryMetadata metadata;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) return std::nullopt;
  }
  ClaimedSize size;
  if (edgebreaker) {
    std::uint8_t traversal = 0;
    if (!buffer.Decode(&traversal) || !draco::DecodeVarint(&size.vertices, &buffer) ||
        !draco::DecodeVarint(&size.faces, &buffer))
      return std::nullopt;
  } else if (!draco::DecodeVarint(&size.faces, &buffer) || !draco::DecodeVarint(&size.vertices, &buffer)) {
    return std::nullopt;
  }
  return size;
}

}  // namespace

struct DracoMesh::State {
  std::unique_ptr<draco::Mesh> mesh;
  std::map<std::string, const draco::PointAttribute*> attributes;
  std::map<std::string, int> accessors;
  std::string what;
};

DracoMesh::DracoMesh(const Document& document, const nlohmann::json& extension, const tinygltf::Primitive& primitive,
                     const std::string& what)
    : state_(std::make_unique<State>()) {
  state_->what = what;
  state_->accessors = primitive.attributes;
  const std::span<const std::uint8_t> bytes = document.views[extension["bufferView"].get<std::size_t>()];
  if (bytes.size() < 16 || std::string(bytes.begin(), bytes.begin() + 5) != "DRACO")
    document.fail(what + " has no Draco data", without_draco);

  // The most regular of meshes pack to a hundred triangles a byte; far beyond that lies no mesh, but
  // memory that would be taken on the word of a damaged file.
  const std::uint64_t plausible = 2048 * std::uint64_t(bytes.size()) + 65536;
  const auto claimed = read_claimed_size(bytes);
  if (!claimed) document.fail(what + " has a Draco stream that is damaged or older than version 2.2", without_draco);
  if (claimed->vertices > plausible || claimed->faces > plausible) {
    document.fail(fmt::format("{} has a Draco stream of {} bytes that claims {} vertices and {} triangles", what,
                              bytes.size(), claimed->vertices, claimed->faces),
                  without_draco);
  }

  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::string cause;
  try {
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (decoded.ok()) {
      state_->mesh = std::move(decoded).value();
    } else {
      cause = decoded.status().error_msg_string();
    }
  } catch (const std::exception& error) {
    cause = error.what();
  }
  if (!state_->mesh) document.fail(what + " has damaged Draco data: " + cause, without_draco);

  for (const auto& [name, id] : extension["attributes"].items()) {
    const draco::PointAttribute* attribute = state_->mesh->GetAttributeByUniqueId(id.get<std::uint32_t>());
    if (attribute == nullptr) document.fail(fmt::format("{} has no {} in its Draco data", what, name), without_draco);
    if (!state_->accessors.contains(name))
      document.fail(fmt::format("{} has {} in its Draco data only", what, name), without_draco);
    state_->attributes[name] = attribute;
  }
}

DracoMesh::~DracoMesh() = default;
DracoMesh::DracoMesh(DracoMesh&&) noexcept = default;
DracoMesh& DracoMesh::operator=(DracoMesh&&) noexcept = default;

std::size_t DracoMesh::vertex_count() const { return state_->mesh->num_points(); }

std::vector<std::uint32_t> DracoMesh::indices() const {
  std::vector<std::uint32_t> result;
  result.reserve(std::size_t(state_->mesh->num_faces()) * 3);
  for (std::uint32_t i = 0; i < state_->mesh->num_faces(); ++i)
    for (const draco::PointIndex& corner : state_->mesh->face(draco::FaceIndex(i))) result.push_back(corner.value());
  return result;
}

bool DracoMesh::has(const std::string& attribute) const { return state_->attributes.contains(attribute); }

std::vector<float> DracoMesh::floats(const Document& document, const std::string& name, int components) const {
  const draco::PointAttribute& attribute = *state_->attributes.at(name);
  const tinygltf::Accessor& accessor = document.model.accessors[std::size_t(state_->accessors.at(name))];
  if (attribute.num_components() != components) {
    document.fail(fmt::format("{} has {} with {} components in its Draco data instead of {}", state_->what, name,
                              int(attribute.num_components()), components),
                  without_draco);
  }
  // glTF's accessor says how integers are meant; Draco's own flag may be missing.
  float divisor = 1;
  if (accessor.normalized && !attribute.normalized()) {
    switch (accessor.componentType) {
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        divisor = 127;
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        divisor = 255;
        break;
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        divisor = 32767;
        break;
      default:
        divisor = 65535;
        break;
    }
  }
  std::vector<float> result(vertex_count() * std::size_t(components));
  for (std::uint32_t i = 0; i < vertex_count(); ++i) {
    float* const out = &result[std::size_t(i) * std::size_t(components)];
    const draco::AttributeValueIndex value = attribute.mapped_index(draco::PointIndex(i));
    const bool good = value.value() < attribute.size() &&
                      attribute.ConvertValue<float>(value, static_cast<std::int8_t>(components), out);
    for (int k = 0; k < components; ++k) out[k] = divisor == 1 ? out[k] : std::max(out[k] / divisor, -1.0F);
    if (!good || !std::all_of(out, out + components, [](float x) { return std::isfinite(x); }))
      document.fail(fmt::format("{} has no finite {} at vertex {}", state_->what, name, i), without_draco);
  }
  return result;
}

}  // namespace ivory::gltf
