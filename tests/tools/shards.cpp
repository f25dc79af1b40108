// ivory bake grid --shards: parts of one size, whose sum is the whole to the byte, and what is said where some are
// missing.
#include "tests/tools/script.h"

namespace ivory::script {

namespace {

TEST(Shards, AddUpToTheWhole) {
  const fs::path folder = scratch_folder("shards");
  const std::string bake = "bake grid " + scene + " --resolution 6 --seed 4 --photons 100003 -q -o ";
  ASSERT_EQ(ivory(folder, bake + "whole.vdb").exit_code, 0);
  constexpr int count = 7;
  std::string all;
  std::uint64_t end = 0;
  for (int i = 0; i < count; ++i) {
    const std::string name = "s" + std::to_string(i) + ".vdb";
    const Outcome outcome = ivory(folder, bake + name + " --json --shards 7 --shard " + std::to_string(i));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Json range = Json::parse(outcome.out)["photon_range"];
    EXPECT_EQ(range[0], end);
    end = range[1].get<std::uint64_t>();
    EXPECT_NEAR(double(end) - range[0].get<double>(), 100003.0 / count, 1);
    all = name + " " + all;  // in any order
  }
  EXPECT_EQ(end, 100003);
  ASSERT_EQ(ivory(folder, "merge " + all + "-o merged.vdb").exit_code, 0);
  EXPECT_EQ(read_file(folder / "merged.vdb"), read_file(folder / "whole.vdb"));

  const auto fails = [&](const std::string& arguments, int exit_code, const std::string& text) {
    const Outcome outcome = ivory(folder, arguments);
    EXPECT_EQ(outcome.exit_code, exit_code) << arguments;
    EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
  };
  fails("merge s0.vdb s1.vdb s3.vdb -o x.vdb", 1, "s3.vdb: photons 28572:42858 before it are missing");
  fs::copy_file(folder / "s1.vdb", folder / "again.vdb");
  fails("merge s0.vdb s1.vdb s2.vdb again.vdb -o x.vdb", 1,
        "again.vdb: its photons 14286:28572 overlap those of s1.vdb");
  EXPECT_FALSE(fs::exists(folder / "x.vdb"));
  const Outcome middle = ivory(folder, "merge s1.vdb s2.vdb -o x.vdb --json");
  ASSERT_EQ(middle.exit_code, 0) << middle.err;
  EXPECT_EQ(Json::parse(middle.out)["missing"], "0:14286 and 42858:100003");

  fails(bake + "y.vdb --shards 7 --shard 7", 2, "0 to 6");
  fails(bake + "y.vdb --shards 7", 2, "--shard");
  fails(bake + "y.vdb --shard 2", 2, "--shards");
  fails(bake + "y.vdb --shards 2 --shard 0 --photon-range 0:5", 2, "--photon-range");
  fails(bake + "y.vdb --shards 200k --shard 0", 2, "100003 photons only");
  fails(bake + "y.vdb --shards 2 --shard 0 --target-error 5%", 2, "--shards");
}

}  // namespace

}  // namespace ivory::script
