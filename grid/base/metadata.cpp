#include "grid/base/metadata.h"

namespace ivory {

namespace {

template <typename T>
std::optional<T> find(const Metadata& metadata, const std::string& key) {
  const auto found = metadata.find(key);
  const T* value = found == metadata.end() ? nullptr : std::get_if<T>(&found->second);
  return value == nullptr ? std::nullopt : std::optional<T>(*value);
}

}  // namespace

std::optional<std::string> find_text(const Metadata& metadata, const std::string& key) {
  return find<std::string>(metadata, key);
}

std::optional<std::int64_t> find_int(const Metadata& metadata, const std::string& key) {
  return find<std::int64_t>(metadata, key);
}

std::optional<double> find_number(const Metadata& metadata, const std::string& key) {
  if (const auto integer = find_int(metadata, key)) return double(*integer);
  return find<double>(metadata, key);
}

}  // namespace ivory
