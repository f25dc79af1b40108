#include "tracer/alias_table.h"

#include <algorithm>

namespace ivory {

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
  const auto keep = [](double probability) {
    return std::uint32_t(std::min(std::max(probability, 0.0) * 0x1p32, 0x1p32 - 1));
  };
  while (!small.empty() && !large.empty()) {
    const std::uint32_t s = small.back();
    small.pop_back();
    const std::uint32_t l = large.back();
    entries_[s] = {keep(scaled[s]), l};
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

}  // namespace ivory
