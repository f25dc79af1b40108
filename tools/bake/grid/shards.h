// A bake in parts of one size, each a command of its own: --shards N --shard I.
#pragma once

#include <cstdint>
#include <utility>

#include "tools/cli/options.h"

namespace ivory {

struct ShardOptions {
  int count = 0;  // of how many the bake is made; 0: it is whole
  int index = 0;  // which of them this is
};

// --shards and --shard, which exclude `photon_range`.
void add_shard_options(Command command, Option photon_range, ShardOptions& options);

// Throws UsageError where there is no such part, or `to_an_error`: then photons are chosen on the way.
void check_shards(const ShardOptions& options, bool to_an_error);

// The first photon of the part, and the one past its last, of all `photons`. Throws UsageError where there are fewer
// than parts.
std::pair<std::uint64_t, std::uint64_t> photons_of(const ShardOptions& options, std::uint64_t photons);

}  // namespace ivory
