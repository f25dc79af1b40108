#include "tracer/core/alias_table.h"

#include <algorithm>

namespace ivory {

// Own code: those of libraries draw from generators of their own and do not tell the probabilities that they come to.
AliasTable::AliasTable(std::span<const double> weights) {
  for (const double weight : weights) total_ += weight;
  if (!(total_ > 0)) return;

  const auto count = weights.size();
  entries_.resize(count);
  std::vector<double> scaled(count);
  std::vector<std::uint32_t> small;
  std::vector<std::uint32_t> large;
  for (std::size_t i = 0; i < count; ++i) {
    scaled[i] = weights[i] / total_ * double(count);
    (scaled[i] < 1 ? small : large).push_back(std::uint32_t(i));
  }
  // Truncated to 0, a light 10^10 times weaker than another would never be picked and its light be missing
  // from every mean.
  const auto keep = [&](std::size_t i) {
    return std::uint32_t(std::clamp(scaled[i] * 0x1p32, weights[i] > 0 ? 1.0 : 0.0, 0x1p32 - 1));
  };
  while (!small.empty() && !large.empty()) {
    const std::uint32_t s = small.back();
    small.pop_back();
    const std::uint32_t l = large.back();
    entries_[s] = {keep(s), l};
    scaled[l] -= 1 - scaled[s];
    if (scaled[l] < 1) {
      large.pop_back();
      small.push_back(l);
    }
  }
  // What is left is 1 up to rounding and always stays. An entry of weight 0 must never be chosen: it
  // is only ever left over by rounding, and then points at one that has weight.
  const auto heaviest = std::uint32_t(std::max_element(weights.begin(), weights.end()) - weights.begin());
  for (const auto* rest : {&small, &large}) {
    for (const std::uint32_t i : *rest)
      entries_[i] = {weights[i] > 0 ? 0xffffffffU : 0U, weights[i] > 0 ? i : heaviest};
  }
}

// Entry i is asked by ceil(2^32 (i + 1) / count) - ceil(2^32 i / count) of the first 32 bits.
std::vector<double> AliasTable::probabilities() const {
  const auto count = std::uint64_t(entries_.size());
  std::vector<double> result(entries_.size(), 0);
  const auto first = [&](std::uint64_t i) { return ((i << 32U) + count - 1) / count; };
  for (std::uint64_t i = 0; i < count; ++i) {
    const Entry& entry = entries_[i];
    const double asked = double(first(i + 1) - first(i)) * 0x1p-32;
    const double kept = double(entry.keep) * 0x1p-32;
    result[i] += asked * kept;
    result[entry.alias] += asked * (1 - kept);
  }
  return result;
}

}  // namespace ivory
