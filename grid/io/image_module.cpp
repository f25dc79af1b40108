// The module ivory_images.so; see image_codec.h. It links nothing of ivory.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string_view>
#include <type_traits>
#include <variant>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <webp/decode.h>

#include "grid/base/error.h"
#include "grid/io/image_codec.h"

namespace ivory {

namespace {

OIIO::TypeDesc type_desc(PixelType type) {
  return type == PixelType::float32 ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8;
}

// What an image says went wrong, in one line, and never nothing.
std::string said(std::string error) {
  while (!error.empty() && error.back() == '\n') error.pop_back();
  return error.empty() ? "OpenImageIO does not say why" : in_one_line(error);
}

// OpenImageIO prints an unread error when the program ends.
std::string last_error() { return said(OIIO::geterror()); }

// TIFF and TGA say it; of formats that keep floats, colour times alpha is what shines.
bool is_premultiplied(const OIIO::ImageSpec& spec, std::string_view format) {
  if (spec.alpha_channel < 0 || spec.format.is_floating_point()) return false;
  constexpr int targa_premultiplied = 4;
  if (format == "targa") return spec.get_int_attribute("targa:alpha_type") == targa_premultiplied;
  return format == "tiff" && spec.get_int_attribute("tiff:UnassociatedAlpha") == 0;
}

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
  if (spec.alpha_channel < spec.nchannels) header.alpha_channel = spec.alpha_channel;
  for (const OIIO::ParamValue& attribute : spec.extra_attribs) {
    const std::string name = attribute.name().string();
    // The last branch takes what is left as text, too. NOLINTNEXTLINE(bugprone-branch-clone)
    if (attribute.type() == OIIO::TypeString) {
      header.attributes[name] = attribute.get_string();
    } else if (attribute.type() == OIIO::TypeInt) {
      header.attributes[name] = std::int64_t(attribute.get_int());
    } else if (attribute.type() == OIIO::TypeFloat) {
      header.attributes[name] = double(attribute.get_float());
    } else if (attribute.type() == OIIO::TypeDesc(OIIO::TypeDesc::DOUBLE)) {
      header.attributes[name] = *static_cast<const double*>(attribute.data());
    } else if (name.starts_with("ivory:")) {
      header.attributes[name] = attribute.get_string();
    }
  }
  header.premultiplied = is_premultiplied(spec, header.format);
  return header;
}

// OpenImageIO multiplies colours by alpha otherwise.
OIIO::ImageSpec unassociated() {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  return config;
}

// OpenImageIO 2.4 reads Maya's IFF past its end where its sizes do not fit together.
constexpr const char* iff_refused = "Maya IFF, which is not read";
bool is_iff(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view magic = "FOR4";
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

class Image : public OpenImage {
 public:
  std::string read(int channels, PixelType type, void* pixels) override {
    return input->read_image(0, 0, 0, channels, type_desc(type), pixels) ? "" : said(input->geterror());
  }

  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory;  // where the file is one in memory
  std::unique_ptr<OIIO::ImageInput> input;
};

// By libwebp itself: OpenImageIO 2.4 gives colours of WebP times alpha, whatever it is asked for.
class WebPImage : public OpenImage {
 public:
  static bool is_webp(std::span<const std::uint8_t> bytes) {
    constexpr std::string_view outer = "RIFF";
    constexpr std::string_view inner = "WEBP";
    return bytes.size() >= 12 && std::equal(outer.begin(), outer.end(), bytes.begin()) &&
           std::equal(inner.begin(), inner.end(), bytes.begin() + 8);
  }
  static std::unique_ptr<OpenImage> open(std::span<const std::uint8_t> bytes, std::string& cause) {
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK) {
      cause = "no WebP header that can be read";
      return nullptr;
    }
    if (features.has_animation != 0) {
      cause = "an animation, not one image";
      return nullptr;
    }
    auto image = std::make_unique<WebPImage>();
    image->bytes = bytes;
    ImageHeader& header = image->header;
    header.width = features.width;
    header.height = features.height;
    header.channel_names = {"R", "G", "B"};
    if (features.has_alpha != 0) header.channel_names.emplace_back("A");
    header.channels = int(header.channel_names.size());
    header.alpha_channel = features.has_alpha != 0 ? 3 : -1;
    header.format = "webp";
    header.pixel_type = "uint8";
    header.attributes["oiio:ColorSpace"] = std::string("sRGB");
    constexpr std::string_view extended = "VP8X";
    constexpr unsigned has_profile = 0x20;
    if (bytes.size() > 20 && std::equal(extended.begin(), extended.end(), bytes.begin() + 12) &&
        (bytes[20] & has_profile) != 0)
      header.attributes["ICCProfile:profile_description"] = std::string("of unread name");
    return image;
  }

  std::string read(int channels, PixelType type, void* pixels) override {
    const std::size_t count = std::size_t(header.width) * std::size_t(header.height);
    const auto all = std::size_t(header.channels);
    const auto wanted = std::size_t(channels);
    std::vector<std::uint8_t> decoded(count * all);
    const auto decode = all == 4 ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
    if (decode(bytes.data(), bytes.size(), decoded.data(), decoded.size(), int(all) * header.width) == nullptr)
      return "it is cut off or no WebP";
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < wanted; ++c) {
        const std::uint8_t value = decoded[i * all + c];
        if (type == PixelType::uint8) {
          static_cast<std::uint8_t*>(pixels)[i * wanted + c] = value;
        } else {
          static_cast<float*>(pixels)[i * wanted + c] = float(value) / 255;
        }
      }
    }
    return "";
  }

  std::span<const std::uint8_t> bytes;
  std::vector<std::uint8_t> file;  // what `bytes` are where nobody else keeps them
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
    if (std::ifstream file(path, std::ios::binary); file) {
      std::vector<std::uint8_t> bytes(12);
      file.read(reinterpret_cast<char*>(bytes.data()), 12);
      if (file && is_iff(bytes)) {
        cause = iff_refused;
        return nullptr;
      }
      if (file && WebPImage::is_webp(bytes)) {
        file.seekg(0);
        bytes.assign(std::istreambuf_iterator<char>(file), {});
        auto image = WebPImage::open(bytes, cause);
        if (image) static_cast<WebPImage&>(*image).file = std::move(bytes);  // the bytes stay where they are
        return image;
      }
    }
    auto image = std::make_unique<Image>();
    const OIIO::ImageSpec config = unassociated();
    image->input = OIIO::ImageInput::open(path, &config);
    if (!image->input) {
      cause = last_error();
      return nullptr;
    }
    image->header = header_of(*image->input);
    return image;
  }

  std::unique_ptr<OpenImage> open(std::span<const std::uint8_t> bytes, const std::string& extension,
                                  std::string& cause) const override {
    if (WebPImage::is_webp(bytes)) return WebPImage::open(bytes, cause);
    if (is_iff(bytes)) {
      cause = iff_refused;
      return nullptr;
    }
    auto image = std::make_unique<Image>();
    image->memory =
        std::make_unique<OIIO::Filesystem::IOMemReader>(const_cast<std::uint8_t*>(bytes.data()), bytes.size());
    const std::string name = "image." + extension;
    const OIIO::ImageSpec config = unassociated();
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

  bool can_write(const std::string& path) const override { return writer(path) != nullptr; }

  std::vector<std::uint8_t> encode(const std::string& path, const ImageToWrite& image,
                                   std::string& cause) const override {
    const std::unique_ptr<OIIO::ImageOutput> output = writer(path);
    if (!output) {
      cause = "no format that can be written";
      return {};
    }
    OIIO::ImageSpec spec(image.width, image.height, int(image.channels.size()),
                         image.linear ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
    spec.channelnames = image.channels;
    spec.attribute("oiio:ColorSpace", image.linear ? "linear" : "sRGB");
    if (output->format_name() == std::string("openexr")) spec.attribute("compression", "zip");
    // OpenImageIO would store the time of day: the same command is to give the same bytes.
    spec.attribute("DateTime", "");
    add_metadata(spec, image.metadata);
    const std::string name = std::filesystem::path(path).filename().string();  // some formats store it
    OIIO::Filesystem::IOVecOutput memory;
    const bool written = output->set_ioproxy(&memory) && output->open(name, spec) &&
                         output->write_image(type_desc(image.type), image.pixels) && output->close();
    if (!written || memory.buffer().empty()) {
      cause = said(output->geterror());
      return {};
    }
    return memory.buffer();
  }

 private:
  // None for formats that only write to files, and for OpenImageIO's sink.
  static std::unique_ptr<OIIO::ImageOutput> writer(const std::string& path) {
    std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(path);
    if (!output) last_error();
    if (output && (output->supports("ioproxy") == 0 || output->format_name() == std::string_view("null") ||
                   output->format_name() == std::string_view("iff")))  // which is not read, see above
      return nullptr;
    return output;
  }
};

}  // namespace

}  // namespace ivory

extern "C" __attribute__((visibility("default"))) const ivory::ImageCodec* ivory_image_codec() {
  static const ivory::Codec codec;
  return &codec;
}
