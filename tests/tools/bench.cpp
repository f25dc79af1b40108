// ivory bench all as a script meets it. Rates are anyone's; that they are there, and belong together, is not.
#include "tests/support/command_test.h"

namespace ivory {
namespace {

using Json = nlohmann::json;

class Bench : public CommandTest {};

TEST_F(Bench, AllSaysWhatMachineAndWhichRows) {
  const Json result = run("bench all --threads 1 --rounds 1 --scale 0.02 --only look-ups");
  EXPECT_FALSE(result.at("cpu").get<std::string>().empty());
  EXPECT_GE(result.at("cores").get<int>(), 1);
  EXPECT_EQ(result.at("threads"), 1);
  EXPECT_FALSE(result.at("isa").get<std::string>().empty());
  ASSERT_EQ(result.at("rows").size(), 3U);
  for (const Json& row : result.at("rows")) {
    const double per_s = row.at("per_s");
    const double bound_per_s = row.at("bound_per_s");
    EXPECT_GT(per_s, 0) << row;
    // One round: the ratio is that of the two rates.
    EXPECT_NEAR(row.at("ratio").get<double>() * bound_per_s / per_s, 1, 1e-9) << row;
    EXPECT_FALSE(row.at("bound").get<std::string>().empty());
  }
}

TEST_F(Bench, AllRefusesRowsThatAreNotThere) { expect_one_line("bench all --only nothing", 2, "--only"); }

}  // namespace
}  // namespace ivory
