#include "tracer/gltf/images.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <zlib.h>

#include "grid/base/memory.h"
#include "grid/io/image_codec.h"

namespace ivory::gltf {
namespace {

using nlohmann::json;

// Deflate packs at most 1032 : 1, and a one-bit PNG has eight pixels a byte; JPEG and WebP stay
// below that. A header that claims more than the file can hold is refused before memory is taken.
constexpr std::uint64_t max_pixels_per_byte = 8 * 1032;
constexpr std::size_t max_side = 32768;

bool starts_with(std::span<const std::uint8_t> bytes, std::size_t at, std::string_view magic) {
  return bytes.size() >= at + magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin() + std::ptrdiff_t(at),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

const char* file_extension(std::span<const std::uint8_t> bytes) {
  if (starts_with(bytes, 0, "\x89PNG\r\n\x1A\n")) return "png";
  if (starts_with(bytes, 0, "\xFF\xD8\xFF")) return "jpg";
  if (starts_with(bytes, 0, "RIFF") && starts_with(bytes, 8, "WEBP")) return "webp";
  return nullptr;
}

std::size_t big_endian(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t count) {
  std::size_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8U | bytes[at + i];
  return value;
}

// libjpeg fills what is missing with grey and calls it a success; the end-of-image marker tells.
// Segments in front of the scan are stepped over, as a thumbnail in one may have an end of its own.
bool jpeg_is_complete(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t start_of_scan = 0xDA;
  std::size_t at = 2;
  while (at + 4 <= bytes.size() && bytes[at] == 0xFF && bytes[at + 1] != start_of_scan)
    at += bytes[at + 1] == 0xFF ? 1 : 2 + big_endian(bytes, at + 2, 2);
  for (; at + 1 < bytes.size(); ++at)
    if (bytes[at] == 0xFF && bytes[at + 1] == 0xD9) return true;
  return false;
}

// All chunks are there with their checksums. libpng would find out as well, but prints what it finds.
bool png_is_sound(std::span<const std::uint8_t> bytes) {
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    const std::size_t length = big_endian(bytes, at, 4);
    if (length > bytes.size() - at - 12) return false;
    const uLong sum = crc32(0, &bytes[at + 4], uInt(length + 4));
    if (sum != big_endian(bytes, at + 8 + length, 4)) return false;
    if (starts_with(bytes, at + 4, "IEND")) return true;
    at += length + 12;
  }
  return false;
}

std::size_t little_endian(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t count) {
  std::size_t value = 0;
  for (std::size_t i = count; i-- > 0;) value = value << 8U | bytes[at + i];
  return value;
}

struct Size {
  std::size_t width = 0;
  std::size_t height = 0;
};

// What the header claims, before a decoder, which may take memory for all of it as it opens the file, sees it.
// 0 x 0 where it is not to be found; no decoder will find it either.
Size claimed_size(std::span<const std::uint8_t> bytes) {
  if (starts_with(bytes, 12, "IHDR") && bytes.size() >= 24) return {big_endian(bytes, 16, 4), big_endian(bytes, 20, 4)};
  if (starts_with(bytes, 0, "\xFF\xD8")) {
    // The frame's header is a segment C0 to CF, of which C4 (Huffman tables), C8 and CC (arithmetic coding) are not.
    for (std::size_t at = 2; at + 9 <= bytes.size() && bytes[at] == 0xFF;) {
      const std::uint8_t kind = bytes[at + 1];
      if ((kind & 0xF0U) == 0xC0 && kind != 0xC4 && kind != 0xC8 && kind != 0xCC)
        return {big_endian(bytes, at + 7, 2), big_endian(bytes, at + 5, 2)};
      at += kind == 0xFF ? 1 : 2 + big_endian(bytes, at + 2, 2);
    }
  }
  if (!starts_with(bytes, 8, "WEBP") || bytes.size() < 30) return {};
  if (starts_with(bytes, 12, "VP8X")) return {little_endian(bytes, 24, 3) + 1, little_endian(bytes, 27, 3) + 1};
  if (starts_with(bytes, 12, "VP8L")) {
    const std::size_t both = little_endian(bytes, 21, 4);
    return {(both & 0x3FFFU) + 1, (both >> 14U & 0x3FFFU) + 1};
  }
  return {little_endian(bytes, 26, 2) & 0x3FFFU, little_endian(bytes, 28, 2) & 0x3FFFU};
}

// Why an image of that size cannot be in so many bytes; empty where it can.
std::string refusal(const Size& size, std::size_t bytes) {
  if (size.width > max_side || size.height > max_side)
    return fmt::format("is {} x {} pixels, beyond {} a side", size.width, size.height, max_side);
  if (size.width * size.height > bytes * max_pixels_per_byte)
    return fmt::format("claims {} x {} pixels in {} bytes", size.width, size.height, bytes);
  return "";
}

// All images stay, at four bytes a pixel. Each thread at work has one more in its hands: up to four bytes a pixel in
// the file's channels, and up to eight of the decoder's own (an interlaced PNG of 16 bits, a progressive JPEG's
// coefficients).
void check_image_memory(const Document& document, std::span<const std::span<const std::uint8_t>> sources) {
  double all = 0;
  double largest = 0;
  for (const std::span<const std::uint8_t> bytes : sources) {
    const Size size = claimed_size(bytes);
    if (!refusal(size, bytes.size()).empty()) continue;  // and never decoded
    const double pixels = double(size.width) * double(size.height);
    all += pixels;
    largest = std::max(largest, pixels);
  }
  const double at_work = std::min(double(tbb::this_task_arena::max_concurrency()), double(sources.size()));
  check_memory(document.path, 4 * all + 12 * at_work * largest, "use smaller images or fewer of them");
}

void expand_to_rgba(std::vector<std::uint8_t>& pixels, std::size_t count, int channels) {
  if (channels == 4) return;
  std::vector<std::uint8_t> rgba(count * 4);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* in = &pixels[i * std::size_t(channels)];
    std::uint8_t* out = &rgba[i * 4];
    out[0] = in[0];
    out[1] = channels >= 3 ? in[1] : in[0];
    out[2] = channels >= 3 ? in[2] : in[0];
    out[3] = channels == 2 ? in[1] : 255;
  }
  pixels = std::move(rgba);
}

}  // namespace

std::string decode_image(std::span<const std::uint8_t> bytes, Image& image) {
  const char* extension = file_extension(bytes);
  if (extension == nullptr) return "is neither PNG nor JPEG nor WebP";
  std::string refused = refusal(claimed_size(bytes), bytes.size());
  if (!refused.empty()) return refused;
  if (extension == std::string_view("png") && !png_is_sound(bytes)) return "is cut off or damaged";
  if (extension == std::string_view("jpg") && !jpeg_is_complete(bytes)) return "is cut off";
  std::string cause;
  const auto file = image_codec().open(bytes, extension, cause);
  if (!file) return fmt::format("cannot be decoded: {}", cause);
  const ImageHeader& header = file->header;
  const Size size = claimed_size(bytes);
  if (header.width < 1 || header.height < 1 || std::size_t(header.width) != size.width ||
      std::size_t(header.height) != size.height) {
    return fmt::format("says it is {} x {} pixels and is {} x {}", size.width, size.height, header.width,
                       header.height);
  }
  const std::size_t pixels = size.width * size.height;
  if (header.channels < 1 || header.channels > 4) return fmt::format("has {} channels", header.channels);

  image.width = header.width;
  image.height = header.height;
  image.rgba.resize(pixels * std::size_t(header.channels));
  if (cause = file->read(header.channels, PixelType::uint8, image.rgba.data()); !cause.empty())
    return fmt::format("cannot be decoded: {}", cause);
  expand_to_rgba(image.rgba, pixels, header.channels);
  return "";
}

void load_images(Document& document, const std::vector<char>& material_used, Scene& scene) {
  const auto images = document.json->find("images");
  const std::size_t count = images == document.json->end() ? 0 : images->size();
  std::vector<char> used(count, 0);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    if (material_used[i] == 0) continue;
    for (const auto slot : texture_slots) {
      const int texture = (scene.materials[i].*slot).texture;
      if (texture == no_index) continue;
      const int image = scene.textures[std::size_t(texture)].image;
      if (image == no_index) {
        document.warn(label("materials", i, scene.materials[i].name) +
                      fmt::format(" uses textures[{}], which has no image that ivory reads; white is used", texture));
      } else {
        used[std::size_t(image)] = 1;
      }
    }
  }

  // Files are read in order, for the hash; decoding takes most of the time and runs in parallel.
  std::vector<std::vector<std::uint8_t>> files(count);
  std::vector<std::span<const std::uint8_t>> sources(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (used[i] == 0) continue;
    const json& image = (*images)[i];
    const std::string what = label("images", i, image.value("name", std::string()));
    if (image.contains("bufferView")) {
      sources[i] = document.views[image["bufferView"].get<std::size_t>()];
    } else {
      files[i] = read_uri(document, image["uri"].get_ref<const std::string&>(), what);
      sources[i] = files[i];
    }
  }
  check_image_memory(document, sources);
  std::vector<Image> decoded(count);
  std::vector<std::string> causes(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    if (used[i] != 0) causes[i] = decode_image(sources[i], decoded[i]);
  });

  std::vector<int> index_in_scene(count, no_index);
  for (std::size_t i = 0; i < count; ++i) {
    if (used[i] == 0) continue;
    const json& image = (*images)[i];
    std::string name = image.value("name", std::string());
    const std::string uri = image.value("uri", std::string());
    if (name.empty() && !uri.starts_with("data:")) name = uri;
    if (!causes[i].empty())
      document.fail(label("images", i, name) + " " + causes[i], "replace the image, or remove it from its material");
    decoded[i].name = name;
    index_in_scene[i] = int(scene.images.size());
    scene.images.push_back(std::move(decoded[i]));
  }
  for (Texture& texture : scene.textures)
    if (texture.image != no_index) texture.image = index_in_scene[std::size_t(texture.image)];
}

}  // namespace ivory::gltf
