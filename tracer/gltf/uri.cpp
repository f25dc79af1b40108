#include "tracer/gltf/uri.h"

#include <algorithm>

namespace ivory::gltf {
namespace {

// RFC 3986, 3.1 and RFC 2045, 6.1: schemes and names of encodings are of any case. `lower` is in lower case.
bool equal_in_any_case(std::string_view text, std::string_view lower) {
  return std::ranges::equal(text, lower,
                            [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

}  // namespace

// Own code: no library that ivory links decodes URIs.
std::string percent_decoded(const std::string& uri) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
  };
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
      path += static_cast<char>(digit(uri[i + 1]) * 16 + digit(uri[i + 2]));
      i += 2;
    } else {
      path += uri[i];
    }
  }
  return path;
}

bool is_data_uri(std::string_view uri) { return equal_in_any_case(uri.substr(0, 5), "data:"); }

std::vector<std::uint8_t> decode_data_uri(const Document& document, const std::string& uri, const std::string& what) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos) document.fail(what + " has a data URI without data", remedy);
  constexpr std::string_view base64 = ";base64";
  const std::string_view head = std::string_view(uri).substr(0, comma);
  if (head.size() < base64.size() || !equal_in_any_case(head.substr(head.size() - base64.size()), base64)) {
    const std::string plain = percent_decoded(uri.substr(comma + 1));
    return {plain.begin(), plain.end()};
  }
  // Lines are broken by some encoders (RFC 2045, 6.8), and RFC 2397 lets any character be written as %xx.
  std::string text = uri.substr(comma + 1);
  if (text.find('%') != std::string::npos) text = percent_decoded(text);
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; });
  std::size_t digits = text.size();
  while (digits > 0 && text[digits - 1] == '=') --digits;
  // tinygltf counts in int and stops silently at the first foreign character.
  if (digits > (1U << 30U)) document.fail(what + " has a data URI of more than 1 GB", "keep it in a file of its own");
  std::vector<std::uint8_t> bytes;
  std::string mime_type;
  const bool decoded =
      tinygltf::DecodeDataURI(&bytes, mime_type, "data:application/octet-stream;base64," + text, 0, false);
  if (!decoded || bytes.size() != digits * 3 / 4) document.fail(what + " has a data URI with broken base64", remedy);
  return bytes;
}

}  // namespace ivory::gltf
