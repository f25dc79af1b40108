// The module ivory_images.so; see image_codec.h. It links nothing of ivory.
#include <limits>
#include <type_traits>
#include <variant>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "grid/io/image_codec.h"

namespace ivory {

namespace {

OIIO::TypeDesc type_desc(PixelType type) {
  return type == PixelType::float32 ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8;
}

// OpenImageIO prints an unread error when the program ends.
std::string last_error() {
  std::string error = OIIO::geterror();
  while (!error.empty() && error.back() == '\n') error.pop_back();
  return error;
}

// What an image says went wrong, never nothing.
std::string said(std::string error) { return error.empty() ? "OpenImageIO does not say why" : error; }

ImageHeader header_of(const OIIO::ImageInput& input) {
  const OIIO::ImageSpec& spec = input.spec();
  ImageHeader header;
  header.width = spec.width;
  header.height = spec.height;
  header.depth = spec.depth;
  header.channels = spec.nchannels;
  header.format = input.format_name();
  header.pixel_type = spec.format.c_str();
  header.channel_names = spec.channelnames;
  for (const OIIO::ParamValue& attribute : spec.extra_attribs) {
    const std::string name = attribute.name().string();
    if (attribute.type() != OIIO::TypeString && !name.starts_with("ivory:")) continue;
    MetaValue& value = header.attributes[name];
    if (attribute.type() == OIIO::TypeInt) {
      value = std::int64_t(attribute.get_int());
    } else if (attribute.type() == OIIO::TypeFloat) {
      value = double(attribute.get_float());
    } else if (attribute.type() == OIIO::TypeDesc(OIIO::TypeDesc::DOUBLE)) {
      value = *static_cast<const double*>(attribute.data());
    } else {
      value = attribute.get_string();
    }
  }
  return header;
}

class Image : public OpenImage {
 public:
  std::string read(int channels, PixelType type, void* pixels) override {
    return input->read_image(0, 0, 0, channels, type_desc(type), pixels) ? "" : said(input->geterror());
  }

  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory;  // where the file is one in memory
  std::unique_ptr<OIIO::ImageInput> input;
};

void add_metadata(OIIO::ImageSpec& spec, const Metadata& metadata) {
  for (const auto& [key, value] : metadata) {
    const std::string attribute = "ivory:" + key;
    std::visit(
        [&](const auto& v) {
          using T = std::decay_t<decltype(v)>;
          if constexpr (std::is_same_v<T, std::string>) {
            spec.attribute(attribute, v);
          } else if constexpr (std::is_same_v<T, double>) {
            spec.attribute(attribute, float(v));
          } else if (v >= std::numeric_limits<int>::min() && v <= std::numeric_limits<int>::max()) {
            spec.attribute(attribute, int(v));
          } else {
            spec.attribute(attribute, std::to_string(v));  // formats keep 32-bit integers only
          }
        },
        value);
  }
}

class Codec : public ImageCodec {
 public:
  std::unique_ptr<OpenImage> open(const std::string& path, std::string& cause) const override {
    auto image = std::make_unique<Image>();
    image->input = OIIO::ImageInput::open(path);
    if (!image->input) {
      cause = last_error();
      return nullptr;
    }
    image->header = header_of(*image->input);
    return image;
  }

  std::unique_ptr<OpenImage> open(std::span<const std::uint8_t> bytes, const std::string& extension,
                                  std::string& cause) const override {
    auto image = std::make_unique<Image>();
    image->memory =
        std::make_unique<OIIO::Filesystem::IOMemReader>(const_cast<std::uint8_t*>(bytes.data()), bytes.size());
    const std::string name = "image." + extension;
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    image->input = OIIO::ImageInput::create(name, false, &config, image->memory.get());
    if (!image->input || !image->input->set_ioproxy(image->memory.get())) {
      cause = last_error();
      return nullptr;
    }
    OIIO::ImageSpec spec;
    if (!image->input->open(name, spec, config)) {
      cause = said(image->input->geterror());
      return nullptr;
    }
    image->header = header_of(*image->input);
    return image;
  }

  bool can_write(const std::string& path) const override {
    const bool can = OIIO::ImageOutput::create(path) != nullptr;
    if (!can) last_error();
    return can;
  }

  std::string write(const std::string& path, const ImageToWrite& image) const override {
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(path);
    if (!output) return last_error();
    OIIO::ImageSpec spec(image.width, image.height, 3, image.linear ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", image.linear ? "linear" : "sRGB");
    if (output->format_name() == std::string("openexr")) spec.attribute("compression", "zip");
    // OpenImageIO would store the time of day: the same command is to give the same bytes.
    spec.attribute("DateTime", "");
    add_metadata(spec, image.metadata);
    const bool written =
        output->open(path, spec) && output->write_image(type_desc(image.type), image.pixels) && output->close();
    return written ? "" : said(output->geterror());
  }
};

}  // namespace

}  // namespace ivory

extern "C" __attribute__((visibility("default"))) const ivory::ImageCodec* ivory_image_codec() {
  static const ivory::Codec codec;
  return &codec;
}
