#include "grid/io/image_info.h"

#include <filesystem>

#include "grid/base/error.h"
#include "grid/io/image_codec.h"

namespace ivory {

Metadata read_image_info(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) throw Error(path, "is not a file", "check the name");
  std::string cause;
  const auto image = image_codec().open(path, cause);
  if (!image) throw Error(path, "cannot be read as an image (" + cause + ")", "give a .vdb, .gltf, .glb or image file");
  const ImageHeader& header = image->header;
  Metadata info;
  info["format"] = header.format;
  info["width"] = std::int64_t(header.width);
  info["height"] = std::int64_t(header.height);
  info["pixel_type"] = header.pixel_type;
  std::string channels;
  for (const std::string& channel : header.channel_names) channels += (channels.empty() ? "" : " ") + channel;
  info["channels"] = channels;
  const std::string prefix = "ivory:";
  for (const auto& [name, value] : header.attributes)
    if (name.starts_with(prefix)) info[name.substr(prefix.size())] = value;
  return info;
}

}  // namespace ivory
