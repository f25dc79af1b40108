#include "grid/io/exr.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <variant>

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfEnvmapAttribute.h>
#include <ImfFloatVectorAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfTestFile.h>
#include <OpenImageIO/hash.h>
#include <fmt/format.h>
#include <half.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/io/file.h"

namespace ivory {

namespace {

const std::string prefix = "ivory:";
const std::string kind_key = prefix + "asset";
const std::string hash_key = prefix + "content_hash";

std::string content_hash(const ExrAsset& asset) {
  std::uint64_t hash = 0;
  const auto add = [&](const void* data, std::size_t bytes) {
    hash = OIIO::xxhash::XXH64(static_cast<const char*>(data), bytes, hash);
  };
  const auto add_text = [&](const std::string& text) { add(text.data(), text.size()); };
  add_text(fmt::format("{} {} {}", asset.kind, asset.width, asset.height));
  for (const std::string& channel : asset.channels) add_text(channel);
  for (const auto& [key, value] : asset.metadata) {
    add_text(key);
    std::visit([&](const auto& v) { add_text(fmt::format("{}", v)); }, value);
  }
  for (const auto& [key, list] : asset.lists) {
    add_text(key);
    add(list.data(), list.size() * sizeof(float));
  }
  add(asset.values.data(), asset.values.size() * sizeof(float));
  return fmt::format("{:016x}", hash);
}

// Attributes of OpenEXR are 32-bit integers, doubles and text; larger integers go as text and stay text.
MetaValue storable(const MetaValue& value) {
  const auto* integer = std::get_if<std::int64_t>(&value);
  if (integer == nullptr || std::int32_t(*integer) == *integer) return value;
  return std::to_string(*integer);
}

void insert_attribute(Imf::Header& header, const std::string& name, const MetaValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    header.insert(name, Imf::IntAttribute(int(*integer)));
  } else if (const auto* number = std::get_if<double>(&value)) {
    header.insert(name, Imf::DoubleAttribute(*number));
  } else {
    header.insert(name, Imf::StringAttribute(std::get<std::string>(value)));
  }
}

Imf::FrameBuffer frame_buffer(std::vector<float>& values, int width, const std::vector<std::string>& channels) {
  Imf::FrameBuffer buffer;
  const std::size_t pixel_bytes = channels.size() * sizeof(float);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    buffer.insert(channels[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data() + c), pixel_bytes,
                                          pixel_bytes * std::size_t(width)));
  }
  return buffer;
}

// OpenEXR completes a file in a destructor, which cannot tell that the disk is full: it writes to memory.
class MemoryFile : public Imf::OStream {
 public:
  MemoryFile() : Imf::OStream("memory") {}
  void write(const char* bytes, int count) override {
    const std::size_t end = at_ + std::size_t(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::copy(bytes, bytes + count, bytes_.begin() + std::ptrdiff_t(at_));
    at_ = end;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

std::string text_attribute(const Imf::Header& header, const std::string& name) {
  const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(name);
  return attribute == nullptr ? std::string() : attribute->value();
}

// The channels' order is not the file's, which is alphabetical.
std::vector<std::string> split_words(const std::string& text) {
  std::vector<std::string> words;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    if (end > begin) words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

ExrAsset read_header(const std::string& path, const Imf::Header& header, const std::string& kind,
                     const std::string& remedy) {
  ExrAsset asset;
  asset.kind = text_attribute(header, kind_key);
  if (asset.kind != kind)
    throw Error(path, asset.kind.empty() ? "is no asset of ivory" : "holds " + asset.kind + ", not " + kind, remedy);
  const Imath::Box2i& window = header.dataWindow();
  asset.width = window.max.x - window.min.x + 1;
  asset.height = window.max.y - window.min.y + 1;
  asset.channels = split_words(text_attribute(header, prefix + "channels"));
  if (asset.channels.empty() || window.min != Imath::V2i(0, 0)) throw Error(path, "is damaged", remedy);
  for (const std::string& channel : asset.channels) {
    if (header.channels().findChannel(channel) == nullptr)
      throw Error(path, "is damaged (channel " + channel + " is missing)", remedy);
  }
  asset.cube_environment = header.findTypedAttribute<Imf::EnvmapAttribute>("envmap") != nullptr;
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string name = it.name();
    if (!name.starts_with(prefix) || name == kind_key || name == hash_key || name == prefix + "channels") continue;
    const std::string key = name.substr(prefix.size());
    const Imf::Attribute& attribute = it.attribute();
    if (const auto* integer = dynamic_cast<const Imf::IntAttribute*>(&attribute)) {
      asset.metadata[key] = std::int64_t(integer->value());
    } else if (const auto* number = dynamic_cast<const Imf::DoubleAttribute*>(&attribute)) {
      asset.metadata[key] = number->value();
    } else if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute)) {
      asset.metadata[key] = text->value();
    } else if (const auto* list = dynamic_cast<const Imf::FloatVectorAttribute*>(&attribute)) {
      asset.lists[key] = list->value();
    }
  }
  return asset;
}

}  // namespace

void write_exr(const std::string& path, const ExrAsset& asset, ExrPrecision precision, bool force) {
  ExrAsset stored = asset;
  for (auto& [key, value] : stored.metadata) value = storable(value);
  for (float& value : stored.values) {
    if (!std::isfinite(value)) throw Error(path, "would hold values that are not finite", "check the inputs");
    if (precision == ExrPrecision::float32) continue;
    if (std::abs(value) > HALF_MAX)
      throw Error(path, "would hold values beyond the range of float16", "store float32, or scale the light down");
    value = float(half(value));
  }

  Imf::Header header(stored.width, stored.height, 1, Imath::V2f(0, 0), 1, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
  std::string order;
  for (const std::string& channel : stored.channels) {
    header.channels().insert(channel, Imf::Channel(precision == ExrPrecision::float32 ? Imf::FLOAT : Imf::HALF));
    order += (order.empty() ? "" : " ") + channel;
  }
  header.insert(kind_key, Imf::StringAttribute(stored.kind));
  header.insert(prefix + "channels", Imf::StringAttribute(order));
  header.insert(hash_key, Imf::StringAttribute(content_hash(stored)));
  for (const auto& [key, value] : stored.metadata) insert_attribute(header, prefix + key, value);
  for (const auto& [key, list] : stored.lists) header.insert(prefix + key, Imf::FloatVectorAttribute(list));
  if (stored.cube_environment) header.insert("envmap", Imf::EnvmapAttribute(Imf::ENVMAP_CUBE));

  MemoryFile memory;
  try {
    Imf::OutputFile file(memory, header);
    Imf::FrameBuffer buffer;
    std::vector<half> halves;
    if (precision == ExrPrecision::float32) {
      buffer = frame_buffer(stored.values, stored.width, stored.channels);
    } else {
      halves.assign(stored.values.begin(), stored.values.end());
      const std::size_t pixel_bytes = stored.channels.size() * sizeof(half);
      for (std::size_t c = 0; c < stored.channels.size(); ++c) {
        buffer.insert(stored.channels[c], Imf::Slice(Imf::HALF, reinterpret_cast<char*>(halves.data() + c), pixel_bytes,
                                                     pixel_bytes * std::size_t(stored.width)));
      }
    }
    file.setFrameBuffer(buffer);
    file.writePixels(stored.height);
  } catch (const std::exception& error) {
    throw Error(path, std::string("cannot be written (") + error.what() + ")", "check the inputs");
  }
  write_file(path, memory.bytes(), force);
}

ExrAsset read_exr(const std::string& path, const std::string& kind, const std::string& remedy) {
  if (!Imf::isOpenExrFile(path.c_str())) throw Error(path, "cannot be read as an OpenEXR file", remedy);
  ExrAsset asset;
  std::string stored_hash;
  try {
    Imf::InputFile file(path.c_str());
    asset = read_header(path, file.header(), kind, remedy);
    stored_hash = text_attribute(file.header(), hash_key);
    const double values = double(asset.width) * double(asset.height) * double(asset.channels.size());
    check_memory(path, values * 8, "bake a smaller one");
    asset.values.resize(std::size_t(values));
    file.setFrameBuffer(frame_buffer(asset.values, asset.width, asset.channels));
    file.readPixels(0, asset.height - 1);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(path, std::string("is damaged (") + error.what() + ")", remedy);
  }
  if (content_hash(asset) != stored_hash) throw Error(path, "is damaged or was edited (checksum)", remedy);
  for (const float value : asset.values) {
    if (!std::isfinite(value)) throw Error(path, "holds values that are not finite", remedy);
  }
  return asset;
}

std::string exr_asset_kind(const std::string& path) {
  if (!Imf::isOpenExrFile(path.c_str())) return {};
  try {
    return text_attribute(Imf::InputFile(path.c_str()).header(), kind_key);
  } catch (const std::exception&) {
    return {};
  }
}

}  // namespace ivory
