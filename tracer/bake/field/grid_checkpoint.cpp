#include "tracer/bake/field/grid_checkpoint.h"

#include <bit>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/io/file.h"
#include "grid/io/vdb/layout.h"
#include "grid/io/vdb/seal.h"
#include "grid/io/vdb/vdb.h"

namespace ivory {
namespace {

const std::string key_name = checkpoint_prefix + "key";
const std::string cpu_name = checkpoint_prefix + "cpu";
const std::string end_name = checkpoint_prefix + "photon_end";

std::string text_of(const MetaValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  return fmt::format("{}", std::get<std::int64_t>(value));
}

std::string bits_of(const GridFrame& frame) {
  std::string text = fmt::format("{} {} {}", frame.size.x, frame.size.y, frame.size.z);
  const auto add = [&](float x) { text += fmt::format(" {:08x}", std::bit_cast<std::uint32_t>(x)); };
  for (unsigned i = 0; i < 3; ++i) {
    add(frame.origin_m[i]);
    add(frame.spacing_m[i]);
    for (unsigned j = 0; j < 3; ++j) add(frame.local_to_world[int(i)][int(j)]);
  }
  return text;
}

// All that decides what is baked, as text to be hashed: numbers to the last bit.
std::string identity(const GridBakeParams& params, const Lattice& lattice, const Metadata& described,
                     std::uint64_t begin, std::uint64_t end) {
  std::string text;
  for (const auto& [key, value] : described) {
    const auto* number = std::get_if<double>(&value);
    text += fmt::format("{}={}\n", key, number != nullptr ? fmt::format("{:a}", *number) : text_of(value));
  }
  text += fmt::format("light={}\nrange={}:{}\npilot_for={}\nframe={}\n", name_of(stored_light(params.include_direct)),
                      begin, end, params.pilot_for_photons, bits_of(lattice.frame));
  for (const BrickLevel& level : lattice.finer) {
    text += fmt::format("level={}\n", bits_of(level.frame));
    for (const V3i& brick : level.stored) text += fmt::format("{},{},{};", brick.x, brick.y, brick.z);
  }
  if (params.groups)
    text += fmt::format("groups={}\nof_light={}\n", fmt::join(params.groups->names, ","),
                        fmt::join(params.groups->of_light, ","));
  return text;
}

}  // namespace

std::string checkpoint_cpu(bool portable) {
  if (portable) return "any";
  __builtin_cpu_init();
  const char* const vendor = __builtin_cpu_is("intel") ? "Intel" : __builtin_cpu_is("amd") ? "AMD" : "other";
  const char* const widest = __builtin_cpu_supports("avx512f")  ? "AVX-512"
                             : __builtin_cpu_supports("avx2")   ? "AVX2"
                             : __builtin_cpu_supports("avx")    ? "AVX"
                             : __builtin_cpu_supports("sse4.2") ? "SSE4.2"
                                                                : "SSE2";
  return std::string(vendor) + " " + widest;
}

std::string checkpoint_fault(const CheckpointPolicy& policy,
                             const std::function<std::string(const Metadata& found)>& fault) {
  std::string why;
  try {
    if (is_sealed_vdb(policy.path)) {
      const Metadata found = read_vdb_info(policy.path);
      why = found.contains(key_name) ? fault(found) : "it is no checkpoint";
    } else {
      why = "it bears no checksum of ivory";
    }
  } catch (const Error& error) {
    if (!policy.replace) throw;
    why = error.what();
  }
  if (why.empty()) return why;
  if (!policy.replace)
    throw Error(policy.path, "holds the unfinished bake of another command (" + why + ")",
                "finish that one, remove this file, or ask to overwrite files");
  if (policy.on_event) {
    policy.on_event(
        {CheckpointEvent::Kind::replaced,
         in_one_line(policy.path + ": is not gone on from, and this bake's checkpoints overwrite it: " + why)});
  }
  return why;
}

GridCheckpoint::GridCheckpoint(const GridBakeParams& params, const Lattice& lattice, const Metadata& described,
                               const std::string& cpu, std::uint64_t begin, std::uint64_t end)
    : policy_(*params.checkpoint), described_(described), begin_(begin), end_(end), clock_(policy_.every_s) {
  for (const auto& [key, value] : policy_.origin) described_[key] = value;
  described_[cpu_name] = cpu;
  key_ = text_hash(identity(params, lattice, described_, begin, end));
  std::error_code unreadable;  // then reading it says why
  if (policy_.path.empty() || !std::filesystem::exists(policy_.path, unreadable)) return;
  is_there_ = true;
  const std::string why = checkpoint_fault(policy_, [&](const Metadata& found) {
    const auto series = find_text(policy_.origin, checkpoint_series);
    if (series && find_text(found, checkpoint_series) == series) {
      is_there_ = find_text(found, key_name) == key_;
      return std::string();
    }
    return fault(found);
  });
  is_there_ = is_there_ && why.empty();
}

std::string GridCheckpoint::fault(const Metadata& found) const {
  if (find_text(found, key_name) == key_) return {};
  // By what people know it, where that tells.
  for (const auto& [key, value] : described_) {
    if (key == "units") continue;  // the file's own stand there
    const auto other = found.find(key);
    if (other == found.end()) return "its " + key + " is not given, here it is " + text_of(value);
    if (other->second != value) return "its " + key + " is " + text_of(other->second) + ", here " + text_of(value);
  }
  return "its photon range, placement, groups of lights or rounds differ";
}

Metadata GridCheckpoint::stored(Metadata of_bake) const {
  for (const auto& [key, value] : policy_.origin) of_bake[key] = value;
  of_bake[cpu_name] = described_.at(cpu_name);
  of_bake[key_name] = key_;
  of_bake[end_name] = std::int64_t(end_);
  return of_bake;
}

GridAccumulator GridCheckpoint::read(GridAccumulator& bake) const {
  GridAccumulator saved = read_accumulator_vdb(policy_.path);
  saved.metadata.erase(light_groups_key);  // the file's, of its groups
  Metadata metadata = std::exchange(bake.metadata, stored(bake.metadata));
  const std::string what = difference(saved, bake);
  bake.metadata = std::move(metadata);
  if (!what.empty() || saved.photon_begin != begin_ || saved.photon_end > end_)
    throw Error(policy_.path, (what.empty() ? "its photon range" : what) + " differs from what this bake has",
                "remove the file, or go on on the machine that it is from");
  report(CheckpointEvent::Kind::resumed,
         fmt::format("{}: going on from {} of {} photons", policy_.path, saved.photon_end - begin_, end_ - begin_),
         saved.photon_end - begin_);
  return saved;
}

bool GridCheckpoint::is_to_stop() {
  if (policy_.stop && policy_.stop()) is_to_stop_ = true;
  return is_to_stop_;
}

bool GridCheckpoint::is_wanted() { return is_to_stop() || (!policy_.path.empty() && clock_.is_due()); }

void GridCheckpoint::write(GridAccumulator& sums) {
  if (policy_.path.empty()) return;
  Metadata metadata = std::exchange(sums.metadata, stored(sums.metadata));
  report(CheckpointEvent::Kind::writing, policy_.path, sums.photon_end - begin_);
  clock_.begin();
  std::string failure;
  try {
    write_vdb(policy_.path, sums, /*force=*/true);
  } catch (const Error& error) {
    if (is_to_stop_) throw;
    failure = error.what();
  }
  sums.metadata = std::move(metadata);
  const double seconds = clock_.end();
  const std::uint64_t done = sums.photon_end - begin_;
  if (failure.empty()) {
    report(CheckpointEvent::Kind::written, fmt::format("{}: {} of {} photons", policy_.path, done, end_ - begin_), done,
           seconds);
  } else {
    report(CheckpointEvent::Kind::failed, failure + "; the bake goes on without this checkpoint", done, seconds);
  }
}

void GridCheckpoint::stop(std::uint64_t done) const {
  throw BakeStopped(policy_.path, done - begin_, end_ - begin_, "photons");
}

void GridCheckpoint::report(CheckpointEvent::Kind kind, std::string line, std::uint64_t done, double seconds) const {
  if (policy_.on_event) policy_.on_event({kind, in_one_line(std::move(line)), done, end_ - begin_, seconds});
}

}  // namespace ivory
