// Every case of the stability suite holds its bounds, and still shows what it is there to show.
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "grid/error.h"
#include "tools/stability.h"

namespace ivory {
namespace {

class Stability : public testing::TestWithParam<StabilityCase> {};

std::string case_name(const testing::TestParamInfo<StabilityCase>& info) { return std::string(info.param.name); }
INSTANTIATE_TEST_SUITE_P(Cases, Stability, testing::ValuesIn(stability_cases()), case_name);

TEST_P(Stability, HoldsItsBounds) {
  const std::vector<StabilityPoint> points = GetParam().run({.quick = true});
  EXPECT_GE(points.size(), 5U);
  int bounded = 0;
  for (const StabilityPoint& p : points) {
    EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.error) && p.error >= 0) << p.series << " at " << p.x;
    if (!p.bound) continue;
    ++bounded;
    EXPECT_LE(p.error, *p.bound) << p.series << " at " << p.x;
  }
  EXPECT_GT(bounded, 0);
}

TEST(StabilitySuite, NamesAreUniqueAndKnown) {
  std::set<std::string_view> names;
  for (const StabilityCase& c : stability_cases()) {
    EXPECT_TRUE(names.insert(c.name).second) << c.name;
    EXPECT_EQ(stability_case(c.name).title, c.title);
    EXPECT_TRUE(c.sentence.ends_with('.')) << c.name;
  }
  EXPECT_THROW(stability_case("no such case"), UsageError);
}

}  // namespace
}  // namespace ivory
