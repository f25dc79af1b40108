// Image files of all formats, through OpenImageIO. Its 250 shared libraries take 0.3 s to load: they are linked by a
// module of its own (image_module.cpp), which is loaded when the first image is met.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "grid/base/metadata.h"

namespace ivory {

// What an image file's header says.
struct ImageHeader {
  int width = 0;
  int height = 0;
  int depth = 1;
  int channels = 0;
  std::string format;      // OpenImageIO's name of it: "openexr"
  std::string pixel_type;  // "half", "uint8"
  std::vector<std::string> channel_names;
  int alpha_channel = -1;      // its index; -1 where there is none
  bool premultiplied = false;  // colours of formats that keep integers are stored times alpha
  Metadata attributes;         // text and single numbers
};

enum class PixelType { uint8, float32 };

// A file that is open for reading.
class OpenImage {
 public:
  virtual ~OpenImage() = default;
  ImageHeader header;
  // The first `channels` of all pixels, top row first, into height x width x channels values. Returns what went wrong,
  // or "".
  virtual std::string read(int channels, PixelType type, void* pixels) = 0;
};

// What is to be written, top row first.
struct ImageToWrite {
  int width = 0;
  int height = 0;
  PixelType type = PixelType::float32;  // of `pixels`
  const void* pixels = nullptr;
  bool linear = true;  // kept as floats; otherwise 8 bits, sRGB
  Metadata metadata;   // becomes attributes "ivory:<name>" where the format keeps attributes
  std::vector<std::string> channels = {"R", "G", "B"};  // more than three in OpenEXR alone
};

class ImageCodec {
 public:
  virtual ~ImageCodec() = default;
  // Both return null and say why in `cause` where the file cannot be opened. `bytes` must outlive the image. Colours
  // behind alpha are as the file has them.
  virtual std::unique_ptr<OpenImage> open(const std::string& path, std::string& cause) const = 0;
  virtual std::unique_ptr<OpenImage> open(std::span<const std::uint8_t> bytes, const std::string& extension,
                                          std::string& cause) const = 0;
  // Whether the name's extension names a format that encode() knows.
  virtual bool can_write(const std::string& path) const = 0;
  // The bytes of a file of that name's format; empty, with what went wrong in `cause`, where it cannot hold the image.
  // To memory, as most formats' writers tell nobody that the disk is full.
  virtual std::vector<std::uint8_t> encode(const std::string& path, const ImageToWrite& image,
                                           std::string& cause) const = 0;
};

// The module's one codec. Thread-safe, as it is itself. Throws Error where the module cannot be loaded.
const ImageCodec& image_codec();

}  // namespace ivory
