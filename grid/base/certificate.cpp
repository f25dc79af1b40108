#include "grid/base/certificate.h"

namespace ivory {
namespace {

const std::string prefix = "certificate_";
const std::string part_prefix = prefix + "part_";

}  // namespace

void keep_certificate(const Certificate& certificate, Metadata& metadata) {
  metadata[prefix + "target"] = certificate.target;
  metadata[prefix + "error"] = certificate.error;
  metadata[prefix + "low"] = certificate.low;
  metadata[prefix + "high"] = certificate.high;
  metadata[prefix + "measure"] = certificate.measure;
  for (const auto& [name, share] : certificate.parts) metadata[part_prefix + name] = share;
}

std::optional<Certificate> find_certificate(const Metadata& metadata) {
  const auto number = [&](const char* key) { return find_number(metadata, prefix + key); };
  if (!number("target") || !number("error") || !number("low") || !number("high")) return std::nullopt;
  Certificate certificate{*number("target"),
                          *number("error"),
                          *number("low"),
                          *number("high"),
                          find_text(metadata, prefix + "measure").value_or(""),
                          {}};
  for (auto it = metadata.lower_bound(part_prefix); it != metadata.end() && it->first.starts_with(part_prefix); ++it) {
    if (const auto share = find_number(metadata, it->first))
      certificate.parts[it->first.substr(part_prefix.size())] = *share;
  }
  return certificate;
}

void remove_certificate(Metadata& metadata) {
  std::erase_if(metadata, [](const auto& entry) { return entry.first.starts_with(prefix); });
}

}  // namespace ivory
