// Choosing one of many in proportion to weights, in constant time: Vose, "A Linear Algorithm for
// Generating Random Numbers with a Given Distribution", 1991.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tracer/core/sampler.h"

namespace ivory {

class AliasTable {
 public:
  AliasTable() = default;
  // Weights are finite and not negative; where all are 0 the table is empty. At most 2^31 entries. Every
  // weight above 0 can be picked, those below 2^-32 / count of the total a little more often than they ask.
  explicit AliasTable(std::span<const double> weights);

  bool empty() const { return entries_.empty(); }
  double total() const { return total_; }

  // Index i with probability weights[i] / total(), up to the table's 32 bits: probabilities() are the exact
  // ones. The table must not be empty.
  std::uint32_t sample(RandomStream& random) const {
    const std::uint32_t u_entry = random.next_u32();
    return pick(u_entry, random.next_u32());
  }
  // The same from two uniform numbers.
  std::uint32_t pick(std::uint32_t u_entry, std::uint32_t u_keep) const {
    const auto i = std::uint32_t((u_entry * std::uint64_t(entries_.size())) >> 32U);
    const Entry& entry = entries_[i];
    return u_keep < entry.keep ? i : entry.alias;
  }

  // With which sample() picks each entry, rounding to the table's integers included: what an unbiased
  // estimator divides by.
  std::vector<double> probabilities() const;

 private:
  struct Entry {
    std::uint32_t keep;  // probability of staying, times 2^32, at least 1 for a weight above 0; an entry that
                         // always stays is its own alias
    std::uint32_t alias;
  };
  std::vector<Entry> entries_;
  double total_ = 0;
};

}  // namespace ivory
