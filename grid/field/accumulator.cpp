#include "grid/field/accumulator.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "grid/base/error.h"

namespace ivory {

SumLayout sum_layout(Basis basis, Estimator estimator) {
  if (estimator != Estimator::track) {
    // A crossed face serves only the hemispheres around its own axis.
    if (basis != Basis::vectors) {
      throw ParameterError("estimator", "'" + std::string(name_of(estimator)) +
                                            "' works with basis 'vectors' only, not '" + std::string(name_of(basis)) +
                                            "'");
    }
    return {6, 3};
  }
  if (basis == Basis::sh9 || basis == Basis::sh4) return {1, function_count(basis)};
  return {8, 3};
}

std::string difference(const GridAccumulator& a, const GridAccumulator& b) {
  for (const auto& [key, value] : a.metadata) {
    const auto found = b.metadata.find(key);
    if (found == b.metadata.end() || found->second != value) return key;
  }
  for (const auto& entry : b.metadata) {
    if (!a.metadata.contains(entry.first)) return entry.first;
  }
  if (a.light != b.light) return "light";
  if (a.basis != b.basis) return "basis";
  if (a.estimator != b.estimator) return "estimator";
  if (a.frame != b.frame || a.finer != b.finer || a.anchor_m != b.anchor_m) return "resolution or placement";
  if (!std::ranges::equal(a.groups, b.groups, {}, &SumGroup::name, &SumGroup::name)) return "groups of lights";
  if (a.quantum != b.quantum || a.quantum_squared != b.quantum_squared) return "fixed-point unit";
  // Of a ray along an edge two kinds of CPU may say different things: Embree has code of its own for each.
  if (a.visible_fraction != b.visible_fraction || a.guard != b.guard)
    return "what vertices see (parts must be baked on one kind of CPU)";
  return {};
}

namespace {

std::string range_text(const GridAccumulator& part) {
  return std::to_string(part.photon_begin) + ":" + std::to_string(part.photon_end);
}

}  // namespace

GridAccumulator merge(std::vector<GridAccumulator> parts, const std::vector<std::string>& names) {
  if (parts.empty()) throw ParameterError("parts", "there are none to merge");
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return parts[a].photon_begin < parts[b].photon_begin; });

  GridAccumulator total = std::move(parts[order[0]]);
  const std::string& first_name = names[order[0]];
  for (std::size_t i = 1; i < order.size(); ++i) {
    const GridAccumulator& part = parts[order[i]];
    const std::string& part_name = names[order[i]];
    if (const std::string what = difference(total, part); !what.empty()) {
      throw Error(part_name, what + " differs from that of " + first_name,
                  "merge parts of one bake that differ in their photons only");
    }
    if (part.photon_begin < total.photon_end) {
      throw Error(part_name, "its photons " + range_text(part) + " overlap those of " + names[order[i - 1]],
                  "give each part once, with ranges that do not overlap");
    }
    if (part.photon_begin > total.photon_end) {
      throw Error(part_name,
                  "photons " + std::to_string(total.photon_end) + ":" + std::to_string(part.photon_begin) +
                      " before it are missing",
                  "bake that range and give it too");
    }
    const auto add = [&](std::vector<std::int64_t>& sums, const std::vector<std::int64_t>& more) {
      for (std::size_t at = 0; at < sums.size(); ++at) {
        if (__builtin_add_overflow(sums[at], more[at], &sums[at]))
          throw Error(part_name, "the sums exceed 64 bits", "merge fewer photons");
      }
    };
    add(total.sums, part.sums);
    for (std::size_t group = 0; group < total.groups.size(); ++group)
      add(total.groups[group].sums, part.groups[group].sums);
    for (const auto& [key, value] : part.counters) total.counters[key] += value;
    total.photon_end = part.photon_end;
  }
  return total;
}

}  // namespace ivory
