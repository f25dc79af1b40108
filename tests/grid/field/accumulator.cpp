// Merging partial bakes: exact, in any order, and refused where parts do not fit together.
#include "grid/field/accumulator.h"

#include <functional>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/io_random.h"

namespace ivory {
namespace {

GridAccumulator part(std::uint64_t begin, std::uint64_t end, std::int64_t value) {
  GridAccumulator sums = test::random_sums(1, Basis::vectors, Estimator::track);
  sums.photon_begin = begin;
  sums.photon_end = end;
  for (std::size_t i = 0; i < sums.sums.size(); ++i) sums.sums[i] = value * std::int64_t(i);
  return sums;
}

std::string error_of(std::vector<GridAccumulator> parts) {
  try {
    merge(std::move(parts), {"a.vdb", "b.vdb", "c.vdb"});
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(Merge, AddsUpExactlyInAnyOrder) {
  const GridAccumulator whole = part(100, 500, 17 - 3 + 8);
  const GridAccumulator merged =
      merge({part(300, 301, -3), part(100, 300, 17), part(301, 500, 8)}, {"a.vdb", "b.vdb", "c.vdb"});
  EXPECT_EQ(merged.sums, whole.sums);
  EXPECT_EQ(merged.counters.at("rays"), 3 * whole.counters.at("rays"));
  EXPECT_EQ(merged.photon_begin, 100);
  EXPECT_EQ(merged.photon_end, 500);
  EXPECT_EQ(merged.metadata, whole.metadata);
  EXPECT_EQ(merged.visible_fraction, whole.visible_fraction);
}

TEST(Merge, OnePartIsItself) { EXPECT_EQ(merge({part(5, 7, 3)}, {"a.vdb"}).sums, part(5, 7, 3).sums); }

TEST(Merge, RefusesOverlapsAndGaps) {
  EXPECT_NE(error_of({part(0, 10, 1), part(9, 20, 1)}).find("b.vdb: its photons 9:20 overlap"), std::string::npos);
  EXPECT_NE(error_of({part(0, 10, 1), part(0, 10, 1)}).find("overlap"), std::string::npos);
  EXPECT_NE(error_of({part(11, 20, 1), part(0, 10, 1)}).find("photons 10:11 before it are missing"), std::string::npos);
}

TEST(Merge, RefusesPartsOfOtherBakes) {
  const std::vector<std::pair<std::string, std::function<void(GridAccumulator&)>>> changes{
      {"method", [](GridAccumulator& s) { s.metadata["method"] = std::string("other"); }},
      {"method", [](GridAccumulator& s) { s.metadata.erase("method"); }},
      {"extra", [](GridAccumulator& s) { s.metadata["extra"] = 1.0; }},
      {"light", [](GridAccumulator& s) { s.light = StoredLight::direct_and_indirect; }},
      {"basis", [](GridAccumulator& s) { s.basis = Basis::vectors9; }},
      {"estimator", [](GridAccumulator& s) { s.estimator = Estimator::face; }},
      {"placement", [](GridAccumulator& s) { s.frame.origin_m.x += 1; }},
      {"fixed-point", [](GridAccumulator& s) { s.quantum *= 2; }},
      {"one kind of CPU", [](GridAccumulator& s) { s.visible_fraction[0] = 0.123F; }},
      {"one kind of CPU", [](GridAccumulator& s) { s.guard.clear(); }},
  };
  for (const auto& [what, change] : changes) {
    GridAccumulator other = part(10, 20, 1);
    change(other);
    EXPECT_NE(error_of({part(0, 10, 1), other}).find(what), std::string::npos) << what;
  }
}

TEST(Merge, RefusesOverflow) {
  GridAccumulator a = part(0, 10, 0);
  GridAccumulator b = part(10, 20, 0);
  a.sums[3] = b.sums[3] = std::numeric_limits<std::int64_t>::max() / 2 + 1;
  EXPECT_NE(error_of({a, b}).find("64 bits"), std::string::npos);
}

}  // namespace
}  // namespace ivory
