#include "grid/io/image_info.h"

#include <filesystem>

#include <OpenImageIO/imageio.h>

#include "grid/base/error.h"

namespace ivory {

Metadata read_image_info(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) throw Error(path, "is not a file", "check the name");
  const auto input = OIIO::ImageInput::open(path);
  if (!input) {
    std::string cause = OIIO::geterror();
    while (!cause.empty() && cause.back() == '\n') cause.pop_back();
    throw Error(path, "cannot be read as an image (" + cause + ")", "give a .vdb, .gltf, .glb or image file");
  }
  const OIIO::ImageSpec& spec = input->spec();
  Metadata info;
  info["format"] = std::string(input->format_name());
  info["width"] = std::int64_t(spec.width);
  info["height"] = std::int64_t(spec.height);
  info["pixel_type"] = std::string(spec.format.c_str());
  std::string channels;
  for (const std::string& channel : spec.channelnames) channels += (channels.empty() ? "" : " ") + channel;
  info["channels"] = channels;
  const std::string prefix = "ivory:";
  for (const OIIO::ParamValue& attribute : spec.extra_attribs) {
    const std::string attribute_name = attribute.name().string();
    if (!attribute_name.starts_with(prefix)) continue;
    const std::string key = attribute_name.substr(prefix.size());
    if (attribute.type() == OIIO::TypeInt) {
      info[key] = std::int64_t(attribute.get_int());
    } else if (attribute.type() == OIIO::TypeFloat || attribute.type() == OIIO::TypeDesc(OIIO::TypeDesc::DOUBLE)) {
      info[key] = attribute.type() == OIIO::TypeFloat ? double(attribute.get_float())
                                                      : *static_cast<const double*>(attribute.data());
    } else {
      info[key] = attribute.get_string();
    }
  }
  return info;
}

}  // namespace ivory
