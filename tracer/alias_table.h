// Choosing one of many in proportion to weights, in constant time: Vose, "A Linear Algorithm for
// Generating Random Numbers with a Given Distribution", 1991.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tracer/sampler.h"

namespace ivory {

class AliasTable {
 public:
  AliasTable() = default;
  // Weights are finite and not negative; where all are 0 the table is empty. At most 2^32 - 1 entries.
  explicit AliasTable(std::span<const double> weights);

  bool empty() const { return entries_.empty(); }
  double total() const { return total_; }

  // Index i with probability weights[i] / total(). The table must not be empty.
  std::uint32_t sample(RandomStream& random) const {
    const auto count = std::uint64_t(entries_.size());
    const auto i = std::uint32_t((random.next_u32() * count) >> 32U);
    const Entry& entry = entries_[i];
    return random.next_u32() < entry.keep ? i : entry.alias;
  }

 private:
  struct Entry {
    std::uint32_t keep;  // probability of staying, times 2^32; an entry that always stays is its own alias
    std::uint32_t alias;
  };
  std::vector<Entry> entries_;
  double total_ = 0;
};

}  // namespace ivory
