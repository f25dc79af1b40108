// --portable: the same bytes whatever vector instructions Embree finds.
#include <cstdlib>
#include <set>

#include "tests/support/command_test.h"

namespace ivory {
namespace {

class Portable : public CommandTest {
 protected:
  // How many different files a bake gives under the instruction sets that this CPU has.
  std::size_t kinds(const std::string& bake, const std::string& name) const {
    std::set<std::string> found;
    for (const std::string isa : {"sse2", "sse4.2", "avx", "avx2", "avx512"}) {
      const std::string output = path(isa + name);
      const RunResult result = run_ivory(bake + " --quiet -o " + output, true,
                                         "LD_PRELOAD=" + std::string(embree_isa) + " EMBREE_CONFIG=isa=" + isa);
      EXPECT_EQ(result.exit_code, 0) << result.output;
      found.insert(bytes_of(output));
    }
    return found.size();
  }
};

TEST_F(Portable, SameBytesUnderEveryInstructionSet) {
  const std::string photons = " --photons 30k --resolution 7,6,6 ";
  const std::string sky = " --env " + scene("sky.hdr");
  const std::string small = " --samples 8,5,3 --env-size 8 --parts 16 --silhouette 16 ";
  const std::string box = "bake grid " + scene("room_boxes_rotated.gltf") + photons;
  // What is compared can differ: without the option it does.
  EXPECT_GT(
      kinds("bake grid " + scene("room_boxes_rotated.gltf") + " --photons 500k --resolution 16,16,16", "differ.vdb"),
      1U);
  EXPECT_EQ(kinds(box + "--portable", "box.vdb"), 1U);
  EXPECT_EQ(kinds("bake grid " + scene("crowd.glb") + sky + photons + "--portable", "crowd.vdb"), 1U);
  EXPECT_EQ(kinds("bake fiv " + scene("detail_low.glb") + sky + small + "--portable", "fiv.exr"), 1U);
  EXPECT_EQ(
      kinds("bake cubemap " + scene("two_rooms.gltf") + " --at 2,1.2,2 --size 4 --capture 8 --samples 4 --portable",
            "c.exr"),
      1U);
}

TEST_F(Portable, TheFileSaysSo) {
  const std::string grid = path("a.vdb");
  const std::string bake = "bake grid " + scene("cornell_box.gltf") + " --photons 10k --resolution 4,4,4 --quiet ";
  ASSERT_EQ(run_ivory(bake + "--portable -o " + grid).exit_code, 0);
  EXPECT_EQ(run("info " + grid).at("hits"), "portable");
  // Sums of one kind of hits and of the other add up to neither.
  ASSERT_EQ(run_ivory(bake + "--photon-range 0:5k -o " + path("b.vdb")).exit_code, 0);
  ASSERT_EQ(run_ivory(bake + "--photon-range 5k:10k --portable -o " + path("c.vdb")).exit_code, 0);
  expect_one_line("merge " + path("b.vdb") + " " + path("c.vdb") + " -o " + path("d.vdb"), 1, "hits");
}

}  // namespace
}  // namespace ivory
