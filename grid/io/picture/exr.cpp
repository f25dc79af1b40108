#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <ImfChannelList.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfRgba.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTestFile.h>
#include <ImfThreading.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/io/picture/formats.h"

namespace ivory {

namespace {

std::string lower(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Channels of one part whose names differ behind the last dot only.
struct Layer {
  int part = 0;
  std::string prefix;                           // of its channels, without the dot
  std::string name;                             // for people: prefix, or the part's name; empty where it has none
  std::map<std::string, std::string> channels;  // by the name behind the dot, in lower case

  std::string find(const char* letter, const char* word) const {
    for (const char* key : {letter, word}) {
      const auto found = channels.find(key);
      if (found != channels.end()) return found->second;
    }
    return "";
  }
  std::string red() const { return find("r", "red"); }
  std::string green() const { return find("g", "green"); }
  std::string blue() const { return find("b", "blue"); }
  bool has_colors() const { return !red().empty() && !green().empty() && !blue().empty(); }
  // Y is a coordinate where X stands beside it.
  bool has_luminance() const { return channels.contains("y") && !channels.contains("x"); }
  bool has_chroma() const { return has_luminance() && channels.contains("ry") && channels.contains("by"); }
  // A lone channel that may be the picture.
  std::string lone() const {
    static const std::vector<std::string> others{"a", "alpha", "z", "depth", "x"};
    if (channels.size() != 1) return "";
    const auto& [key, channel] = *channels.begin();
    return std::find(others.begin(), others.end(), key) == others.end() ? channel : "";
  }
};

std::vector<Layer> layers_of(const Imf::MultiPartInputFile& file, int& deep_parts) {
  std::vector<Layer> layers;
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    if (header.hasType() && Imf::isDeepData(header.type())) {
      ++deep_parts;
      continue;
    }
    std::map<std::string, Layer> by_prefix;
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
      const std::string channel = it.name();
      const std::size_t dot = channel.rfind('.');
      const std::string prefix = dot == std::string::npos ? "" : channel.substr(0, dot);
      Layer& layer = by_prefix[prefix];
      layer.part = part;
      layer.prefix = prefix;
      layer.name = prefix.empty() && file.parts() > 1 && header.hasName() ? header.name() : prefix;
      layer.channels[lower(channel.substr(dot == std::string::npos ? 0 : dot + 1))] = channel;
    }
    for (auto& [prefix, layer] : by_prefix) layers.push_back(std::move(layer));
  }
  return layers;
}

// How much a layer's name says that it is the finished picture: 0 most, 3 not at all.
int rank_of(const Layer& layer) {
  if (layer.name.empty()) return 0;
  const std::string name = lower(layer.name);
  const std::string last = name.substr(name.rfind('.') + 1);
  static const std::vector<std::string> finished{"combined", "beauty", "rgba",  "rgb",
                                                 "color",    "colour", "image", "main"};
  if (std::find(finished.begin(), finished.end(), last) == finished.end()) return 3;
  return name.starts_with("composite.") ? 1 : 2;
}

std::string quoted(const std::vector<Layer>& layers) {
  std::vector<std::string> names;
  for (const Layer& layer : layers) names.push_back(layer.name.empty() ? "the unnamed one" : "'" + layer.name + "'");
  return fmt::format("{}", fmt::join(names, ", "));
}

Layer choose_layer(const std::string& path, const std::vector<Layer>& all, std::vector<std::string>& warnings) {
  std::vector<Layer> candidates;
  const auto collect = [&](const auto& suits) {
    if (!candidates.empty()) return;
    for (const Layer& layer : all)
      if (suits(layer)) candidates.push_back(layer);
  };
  collect([](const Layer& layer) { return layer.has_colors(); });
  collect([](const Layer& layer) { return layer.has_luminance(); });
  collect([](const Layer& layer) { return !layer.lone().empty(); });
  if (candidates.empty()) {
    std::vector<std::string> names;
    for (const Layer& layer : all)
      for (const auto& [key, channel] : layer.channels) names.push_back(channel);
    throw Error(path, fmt::format("has neither R, G and B nor Y, but {}", fmt::join(names, ", ")),
                "export it with channels R, G, B");
  }
  const auto by_rank = [](const Layer& a, const Layer& b) { return rank_of(a) < rank_of(b); };
  std::stable_sort(candidates.begin(), candidates.end(), by_rank);
  if (candidates.size() == 1) return candidates.front();
  if (rank_of(candidates[0]) == rank_of(candidates[1]))
    throw Error(path, "has several layers, and none is plainly the picture: " + quoted(candidates),
                "export the one that you mean alone");
  const std::vector<Layer> others(candidates.begin() + 1, candidates.end());
  warnings.push_back(fmt::format("has {} layers: {} is taken, not {}", candidates.size(), quoted({candidates.front()}),
                                 quoted(others)));
  return candidates.front();
}

struct Window {
  std::int64_t x = 0, y = 0, width = 0, height = 0;
};
Window window_of(const Imath::Box2i& box) {
  return {box.min.x, box.min.y, std::int64_t(box.max.x) - box.min.x + 1, std::int64_t(box.max.y) - box.min.y + 1};
}

// The data window's texels of three channels, or of one in all three.
std::vector<Rgb> read_channels(Imf::InputPart& part, const Window& data, const std::vector<std::string>& channels) {
  std::vector<Rgb> texels(std::size_t(data.width) * std::size_t(data.height), Rgb(0, 0, 0));
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    char* base =
        reinterpret_cast<char*>(&texels.front().x + c) - (data.y * data.width + data.x) * std::int64_t(sizeof(Rgb));
    buffer.insert(channels[c], Imf::Slice(Imf::FLOAT, base, sizeof(Rgb), sizeof(Rgb) * std::size_t(data.width)));
  }
  part.setFrameBuffer(buffer);
  part.readPixels(int(data.y), int(data.y + data.height - 1));
  if (channels.size() == 1)
    for (Rgb& texel : texels) texel = Rgb(texel.x, texel.x, texel.x);
  return texels;
}

// Luminance and subsampled chroma, by OpenEXR's own filter.
std::vector<Rgb> read_chroma(const std::string& path, const Window& data, const std::string& layer) {
  Imf::RgbaInputFile file(path.c_str(), layer);
  std::vector<Imf::Rgba> rgba(std::size_t(data.width) * std::size_t(data.height));
  file.setFrameBuffer(rgba.data() - (data.y * data.width + data.x), 1, std::size_t(data.width));
  file.readPixels(int(data.y), int(data.y + data.height - 1));
  std::vector<Rgb> texels;
  texels.reserve(rgba.size());
  for (const Imf::Rgba& p : rgba) texels.emplace_back(p.r, p.g, p.b);
  return texels;
}

// What the display window shows of the data window; black where there is nothing.
std::vector<Rgb> displayed(const std::vector<Rgb>& texels, const Window& data, const Window& display) {
  std::vector<Rgb> out(std::size_t(display.width) * std::size_t(display.height), Rgb(0, 0, 0));
  const std::int64_t left = std::max(data.x, display.x);
  const std::int64_t right = std::min(data.x + data.width, display.x + display.width);
  const std::int64_t bottom = std::min(data.y + data.height, display.y + display.height);
  for (std::int64_t y = std::max(data.y, display.y); y < bottom && left < right; ++y) {
    const auto from = texels.begin() + ((y - data.y) * data.width + left - data.x);
    std::copy(from, from + (right - left), out.begin() + ((y - display.y) * display.width + left - display.x));
  }
  return out;
}

// Fits the picture into its display window; `whole` where the data window is the picture.
void set_texels(StoredPicture& picture, const std::string& path, std::vector<Rgb> texels, const Window& data,
                const Window& display, bool whole) {
  const bool same =
      data.x == display.x && data.y == display.y && data.width == display.width && data.height == display.height;
  const Window& shown = whole ? data : display;
  picture.width = int(shown.width);
  picture.height = int(shown.height);
  if (same || whole) {
    picture.texels = std::move(texels);
    return;
  }
  const std::int64_t width = std::min(data.x + data.width, display.x + display.width) - std::max(data.x, display.x);
  const std::int64_t height = std::min(data.y + data.height, display.y + display.height) - std::max(data.y, display.y);
  if (width <= 0 || height <= 0)
    throw Error(path, "has its data window outside of its display window", "export it without cropping");
  if (width * height < display.width * display.height)
    picture.warnings.push_back(fmt::format(
        "is cropped: its data window covers {:.3g} % of {} x {} texels, the rest is black",
        100.0 * double(width * height) / double(display.width * display.height), display.width, display.height));
  if (width < data.width || height < data.height)
    picture.warnings.push_back(fmt::format("has {} x {} texels of overscan around {} x {}: they are left out",
                                           data.width, data.height, display.width, display.height));
  picture.texels = displayed(texels, data, display);
}

void set_colors(StoredPicture& picture, const Imf::Header& header) {
  if (Imf::hasChromaticities(header)) {
    const Imf::Chromaticities& c = Imf::chromaticities(header);
    const auto xy = [](const Imath::V2f& v) { return Imath::V2d(v.x, v.y); };
    picture.primaries = {xy(c.red), xy(c.green), xy(c.blue), xy(c.white)};
  }
  if (Imf::hasWhiteLuminance(header)) {
    const float nits = Imf::whiteLuminance(header);
    if (nits > 0 && std::isfinite(nits)) picture.nits = nits;
  }
}

StoredPicture read_file(const std::string& path, const std::string& remedy) {
  // OpenEXR starts without threads, which small files need not wait for.
  constexpr std::uintmax_t worth_threads = 4 << 20;
  if (Imf::globalThreadCount() == 0 && std::filesystem::file_size(path) > worth_threads)
    Imf::setGlobalThreadCount(int(std::max(1U, std::thread::hardware_concurrency())));
  Imf::MultiPartInputFile file(path.c_str());
  StoredPicture picture;
  const Imf::Header& first = file.header(0);
  if (const auto* asset = first.findTypedAttribute<Imf::StringAttribute>("ivory:asset")) picture.asset = asset->value();
  int deep_parts = 0;
  const std::vector<Layer> layers = layers_of(file, deep_parts);
  if (layers.empty()) {
    throw Error(path, deep_parts > 0 ? "is a deep image, of many samples a pixel" : "has no colour channels",
                deep_parts > 0 ? "flatten it" : remedy);
  }
  const auto has_colors = [](const Layer& layer) { return layer.has_colors(); };
  if (!picture.asset.empty() && std::none_of(layers.begin(), layers.end(), has_colors))
    throw Error(path, "is baked (" + picture.asset + "), no picture", remedy);
  const Layer layer = choose_layer(path, layers, picture.warnings);
  picture.layer = layer.name;
  const Imf::Header& header = file.header(layer.part);
  const Window data = window_of(header.dataWindow());
  const Window display = window_of(header.displayWindow());
  if (Imf::hasEnvmap(header))
    picture.layout = Imf::envmap(header) == Imf::ENVMAP_CUBE ? EnvironmentLayout::cube : EnvironmentLayout::latlong;
  for (const Window& window : {data, display}) check_claimed_size(path, window.width, window.height);
  check_memory(
      path,
      2 * sizeof(Rgb) * (double(data.width) * double(data.height) + double(display.width) * double(display.height)),
      "scale it down");
  set_colors(picture, header);

  std::vector<Rgb> texels;
  if (!layer.has_colors() && layer.has_chroma()) {
    if (layer.part != 0)
      throw Error(path, "has luminance and chroma in a part that is not its first", "export it with channels R, G, B");
    texels = read_chroma(path, data, layer.prefix);
  } else {
    std::vector<std::string> channels{layer.has_luminance() ? layer.channels.at("y") : layer.lone()};
    if (layer.has_colors()) channels = {layer.red(), layer.green(), layer.blue()};
    for (const std::string& name : channels) {
      const Imf::Channel* channel = header.channels().findChannel(name);
      if (channel->xSampling != 1 || channel->ySampling != 1)
        throw Error(path, "has its channel " + name + " not at every pixel", "export it with channels R, G, B");
    }
    Imf::InputPart part(file, layer.part);
    texels = read_channels(part, data, channels);
  }
  set_texels(picture, path, std::move(texels), data, display, picture.layout.has_value());
  return picture;
}

}  // namespace

bool is_exr_picture(const std::string& path) { return Imf::isOpenExrFile(path.c_str()); }

StoredPicture read_exr_picture(const std::string& path, const std::string& remedy) {
  try {
    return read_file(path, remedy);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(path, std::string("is damaged (") + error.what() + ")", "export it again");
  }
}

}  // namespace ivory
