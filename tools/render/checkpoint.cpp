#include "tools/render/checkpoint.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/io/exr.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

const std::string kind = "render_checkpoint";
const std::string remedy = "only 'ivory render --checkpoint' makes it";

std::string half_channel(int half, int channel) { return fmt::format("half{}.{:02}", half, channel); }

std::string text_of(const MetaValue& value) {
  return std::visit([](const auto& v) { return fmt::format("{}", v); }, value);
}

std::uint64_t count(const std::vector<std::uint32_t>& samples, int halves) {
  std::uint64_t all = 0;
  for (const std::uint32_t s : samples) all += std::uint64_t(s) * std::uint64_t(halves);
  return all;
}

}  // namespace

void write_film_sums(const std::string& path, const FilmSums& sums, const Metadata& identity) {
  ExrAsset asset;
  asset.kind = kind;
  asset.width = sums.width;
  asset.height = sums.height;
  asset.channels = {"R", "G", "B", "samples", "goal"};
  for (int half = 0; half < sums.halves; ++half) {
    for (int c = 0; c < sums.channels; ++c) asset.channels.push_back(half_channel(half, c));
  }
  asset.values.reserve(sums.pixel_count() * asset.channels.size());
  for (std::size_t i = 0; i < sums.pixel_count(); ++i) {
    const Rgb mean = sums.radiance(i);
    for (const float value : {mean.x, mean.y, mean.z, float(sums.samples[i]), float(sums.goal[i])})
      asset.values.push_back(value);
    for (int half = 0; half < sums.halves; ++half) {
      const float* first = &sums.sums[std::size_t(half)][i * std::size_t(sums.channels)];
      asset.values.insert(asset.values.end(), first, first + sums.channels);
    }
  }
  for (const auto& [key, value] : identity) asset.metadata["picture_" + key] = value;
  asset.metadata["units"] = std::string("nits");
  asset.metadata["halves"] = std::int64_t(sums.halves);
  asset.metadata["channels_a_half"] = std::int64_t(sums.channels);
  asset.metadata["rounds"] = std::int64_t(sums.rounds);
  asset.metadata["seconds"] = sums.seconds;
  asset.metadata["samples_mean"] = double(count(sums.samples, sums.halves)) / double(sums.pixel_count());
  write_exr(path, asset, ExrPrecision::float32, /*force=*/true);
}

StoredSums read_film_sums(const std::string& path) {
  ExrAsset asset = read_exr(path, kind, remedy);
  const auto halves = find_int(asset.metadata, "halves");
  const auto channels = find_int(asset.metadata, "channels_a_half");
  const auto rounds = find_int(asset.metadata, "rounds");
  const auto seconds = find_number(asset.metadata, "seconds");
  const bool sound = halves && (*halves == 1 || *halves == 2) && channels &&
                     (*channels == FilmSums::radiance_channels || *channels == FilmSums::channels_with_features) &&
                     rounds && *rounds >= 1 && seconds && *seconds >= 0 &&
                     asset.channels.size() == std::size_t(5 + *halves * *channels);
  if (!sound) throw Error(path, "lacks what a checkpoint of a picture has", "remove it");
  StoredSums stored;
  FilmSums& sums = stored.sums;
  sums = make_film_sums(asset.width, asset.height, int(*halves), *channels == FilmSums::channels_with_features);
  sums.rounds = int(*rounds);
  sums.seconds = *seconds;
  const auto index_of = [&](const std::string& channel) {
    const auto found = std::find(asset.channels.begin(), asset.channels.end(), channel);
    if (found == asset.channels.end()) throw Error(path, "has no channel " + channel, "remove it");
    return std::size_t(found - asset.channels.begin());
  };
  const auto value = [&](std::size_t pixel, std::size_t channel) {
    return asset.values[pixel * asset.channels.size() + channel];
  };
  const std::size_t samples = index_of("samples");
  const std::size_t goal = index_of("goal");
  for (std::size_t i = 0; i < sums.pixel_count(); ++i) {
    const float most = value(i, goal);
    if (!(value(i, samples) >= 0 && value(i, samples) <= most && most <= 0x1p24F))
      throw Error(path, "has numbers of samples that cannot be", "remove it");
    sums.samples[i] = std::uint32_t(value(i, samples));
    sums.goal[i] = std::uint32_t(most);
  }
  for (int half = 0; half < sums.halves; ++half) {
    for (int c = 0; c < sums.channels; ++c) {
      const std::size_t channel = index_of(half_channel(half, c));
      for (std::size_t i = 0; i < sums.pixel_count(); ++i)
        sums.sums[std::size_t(half)][i * std::size_t(sums.channels) + std::size_t(c)] = value(i, channel);
    }
  }
  for (const auto& [key, v] : asset.metadata) {
    if (key.starts_with("picture_")) stored.identity[key.substr(8)] = v;
  }
  return stored;
}

PictureCheckpoint::PictureCheckpoint(const CheckpointPolicy& policy, RenderParams& params)
    : policy_(policy), clock_(policy.every_s) {
  params.wants_pause = [this] {
    if (policy_.stop && policy_.stop()) is_to_stop_ = true;
    return is_to_stop_ ? PauseWish::at_once : clock_.is_due() ? PauseWish::soon : PauseWish::none;
  };
  params.pause = [this](const FilmSums& sums) { pause(sums); };
  std::error_code unreadable;  // then reading it says why
  if (!fs::exists(policy_.path, unreadable)) return;
  std::string why;
  try {
    StoredSums found = read_film_sums(policy_.path);
    why = fault(found, params);
    if (why.empty()) {
      const std::uint64_t done = count(found.sums.samples, found.sums.halves);
      if (policy_.on_event) {
        policy_.on_event({CheckpointEvent::Kind::resumed,
                          fmt::format("{}: going on from {:.4g} samples a pixel", policy_.path,
                                      double(done) / double(found.sums.pixel_count())),
                          done, count(found.sums.goal, found.sums.halves)});
      }
      params.begin_with = std::move(found.sums);
      return;
    }
  } catch (const Error& error) {
    if (!policy_.replace) throw;
    why = error.what();
  }
  if (!policy_.replace)
    throw Error(policy_.path, "holds the unfinished picture of another command (" + why + ")",
                "finish that one, remove this file, or ask to overwrite files");
  if (policy_.on_event) {
    policy_.on_event(
        {CheckpointEvent::Kind::replaced,
         in_one_line(policy_.path + ": is not gone on from, and this picture's checkpoints overwrite it: " + why)});
  }
}

std::string PictureCheckpoint::fault(const StoredSums& found, const RenderParams& params) const {
  for (const auto& [key, value] : policy_.origin) {
    const auto other = found.identity.find(key);
    if (other == found.identity.end()) return "its " + key + " is not given, here it is " + text_of(value);
    if (text_of(other->second) != text_of(value))
      return "its " + key + " is " + text_of(other->second) + ", here " + text_of(value);
  }
  for (const auto& [key, value] : found.identity) {
    if (!policy_.origin.contains(key)) return "its " + key + " is " + text_of(value) + ", here it is not given";
  }
  const int halves = params.adaptive || params.halves ? 2 : 1;
  if (found.sums.halves != halves || found.sums.has_features() != (params.first_hits_of != nullptr))
    return "its halves or first hits are others";
  if (find_text(found.identity, "size") != fmt::format("{}x{}", found.sums.width, found.sums.height))
    return "it has another size than it says";
  return {};
}

void PictureCheckpoint::pause(const FilmSums& sums) {
  const std::uint64_t done = count(sums.samples, sums.halves);
  const std::uint64_t total = count(sums.goal, sums.halves);
  const auto report = [&](CheckpointEvent::Kind event, const std::string& line, double seconds = 0) {
    if (policy_.on_event) policy_.on_event({event, in_one_line(line), done, total, seconds});
  };
  report(CheckpointEvent::Kind::writing, policy_.path);
  clock_.begin();
  std::string failure;
  try {
    write_film_sums(policy_.path, sums, policy_.origin);
  } catch (const Error& error) {
    if (is_to_stop_) throw;
    failure = error.what();
  }
  const double seconds = clock_.end();
  if (failure.empty()) {
    report(CheckpointEvent::Kind::written, policy_.path, seconds);
  } else {
    report(CheckpointEvent::Kind::failed, failure + "; the picture goes on without this checkpoint", seconds);
  }
  if (is_to_stop_) throw BakeStopped(policy_.path, done, total, "samples of this round");
}

}  // namespace ivory
