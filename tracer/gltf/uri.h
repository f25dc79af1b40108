// URIs of glTF files: what is written as %xx, and what stands in the URI itself. Private to the loader.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tracer/gltf/document.h"

namespace ivory::gltf {

// The text with %xx resolved; what is no such thing stays as it is.
std::string percent_decoded(const std::string& uri);

bool is_data_uri(std::string_view uri);

// The bytes that a data: URI holds, in base64 or as text. Throws Error where it holds none; `what` names its user in
// messages.
std::vector<std::uint8_t> decode_data_uri(const Document& document, const std::string& uri, const std::string& what);

}  // namespace ivory::gltf
