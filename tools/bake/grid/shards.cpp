#include "tools/bake/grid/shards.h"

#include <fmt/format.h>

#include "tools/cli/usage_error.h"

namespace ivory {

void add_shard_options(Command command, Option photon_range, ShardOptions& options) {
  Option shards = command.add_count("--shards", options.count, 1, 1'000'000,
                                    "The same for one of so many parts of one size, the one that --shard says");
  shards.excludes(photon_range);
  Option shard = command.add_count("--shard", options.index, 0, "Which part, from 0 to N-1 of --shards N");
  shard.needs(shards);
  shards.needs(shard);
}

void check_shards(const ShardOptions& options, bool to_an_error) {
  if (options.index >= options.count)
    throw UsageError(fmt::format("--shard: those of --shards {} are 0 to {}", options.count, options.count - 1));
  if (to_an_error)
    throw UsageError("--shards: a bake to an error chooses its photons as it goes: give --photons instead");
}

std::pair<std::uint64_t, std::uint64_t> photons_of(const ShardOptions& options, std::uint64_t photons) {
  const auto count = std::uint64_t(options.count);
  if (count > photons) throw UsageError(fmt::format("--shards: there are {} photons only", photons));
  const auto begin = [&](std::uint64_t i) { return photons / count * i + photons % count * i / count; };
  return {begin(std::uint64_t(options.index)), begin(std::uint64_t(options.index) + 1)};
}

}  // namespace ivory
